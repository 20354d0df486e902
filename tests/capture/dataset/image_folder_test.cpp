// Image folders in KITTI's and EuRoC's layouts.

#include "capture/dataset/image_folder.hpp"

#include <fstream>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "capture/stereo_source.hpp"
#include "support/capture/written_files.hpp"
#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_data.hpp"

namespace cartvo::capture {
namespace {

namespace fs = std::filesystem;
using test::writePicture;
using test::writeText;
using testing::HasSubstr;

constexpr std::chrono::milliseconds kAtOnce{0};
constexpr char kCalibration[] =
    "P0: 700 0 320 0 0 700 240 0 0 0 1 0\nP1: 700 0 320 -80.5 0 700 240 0 0 0 1 0\n";

void writeKitti(const fs::path& folder, int count) {
  std::string times;
  for (int i = 0; i < count; ++i) {
    char name[16];
    std::snprintf(name, sizeof(name), "%06d.png", i);
    writePicture(folder / "image_0" / name, {32, 24}, i);
    writePicture(folder / "image_1" / name, {32, 24}, 100 + i);
    times += std::to_string(i) + ".5e-01\n";
  }
  writeText(folder / "times.txt", times);
  writeText(folder / "calib.txt", kCalibration);
}

void writeEuroc(const fs::path& folder, int count) {
  for (const char* camera : {"cam0", "cam1"}) {
    std::string list =
        camera == std::string("cam0") ? "#timestamp [ns],filename\r\n" : "timestamp,filename\n";
    for (int i = 0; i < count; ++i) {
      const std::string instant = std::to_string(1403715273262142976 + i * 50000000LL);
      writePicture(folder / camera / "data" / (instant + ".png"), {32, 24}, i);
      list.append(instant).append(",").append(instant).append(".png\r\n");
    }
    writeText(folder / camera / "data.csv", list);
    writeText(folder / camera / "sensor.yaml", "sensor_type: camera\n");
  }
}

std::string readError(const fs::path& folder) {
  return test::messageOf([&] { readImageFolder(folder); });
}

TEST(ImageFolder, ReadsKittiLayout) {
  const test::TemporaryFolder folder;
  writeKitti(folder.path(), 3);
  const ImageFolder read = readImageFolder(folder.path());
  EXPECT_EQ(read.layout, FolderLayout::kitti);
  EXPECT_EQ(read.left.instants_ns, (std::vector<std::int64_t>{50000000, 150000000, 250000000}));
  EXPECT_EQ(read.right.instants_ns, read.left.instants_ns);
  EXPECT_EQ(nominalPeriodNs(read.left), 100000000);
  EXPECT_EQ(read.calib_file, folder / "calib.txt");
  EXPECT_EQ(read.cameras, (std::array{0, 1}));
  EXPECT_THAT(read.warnings, testing::IsEmpty());
  EXPECT_TRUE(read.rig_file.empty());
}

TEST(ImageFolder, PrefersTimesOfEachCamera) {
  const test::TemporaryFolder folder;
  writeKitti(folder.path(), 3);
  fs::rename(folder / "image_1/000000.png", folder / "image_1/a.png");  // names need not correspond
  writeText(folder / "times_0.txt", "1\n2\n3\n");
  writeText(folder / "times_1.txt", "1.025\n2.025\n3.025\n");
  writeText(folder / "rig.yaml", "rig\n");
  const ImageFolder read = readImageFolder(folder.path());
  EXPECT_EQ(read.left.instants_ns[1], 2000000000);
  EXPECT_EQ(read.right.instants_ns[1], 2025000000);
  EXPECT_EQ(read.rig_file, folder / "rig.yaml");
}

TEST(ImageFolder, ReadsEurocLayoutFromEitherFolder) {
  const test::TemporaryFolder folder;
  writeEuroc(folder / "mav0", 3);
  for (const fs::path& path : {folder.path(), folder / "mav0"}) {
    const ImageFolder read = readImageFolder(path);
    EXPECT_EQ(read.layout, FolderLayout::euroc);
    ASSERT_EQ(read.left.images.size(), 3U);
    EXPECT_EQ(read.left.instants_ns[2], 1403715273362142976);
    EXPECT_EQ(read.sensor_files[1], folder / "mav0/cam1/sensor.yaml");
    EXPECT_TRUE(read.calib_file.empty());
  }
}

TEST(ImageFolder, DeliversImagesWithTheirInstants) {
  const test::TemporaryFolder folder;
  writeKitti(folder.path(), 3);
  ImageSequenceSource source(readImageFolder(folder.path()).right);
  Frame frame;
  for (std::uint64_t i = 0; i < 3; ++i) {
    ASSERT_EQ(source.read(frame, kAtOnce), ReadOutcome::frame);
    EXPECT_EQ(frame.sequence, i);
    EXPECT_EQ(frame.image.at<std::uint8_t>(5, 5), 100 + i);
    EXPECT_EQ(frame.exposure_ns, 50000000 + static_cast<std::int64_t>(i) * 100000000);
    EXPECT_EQ(frame.instant_source, InstantSource::file);
  }
  EXPECT_EQ(source.read(frame, kAtOnce), ReadOutcome::ended);
  EXPECT_EQ(source.health().frames, 3U);
  EXPECT_EQ(source.health().state, CameraState::ended);
}

TEST(ImageFolder, EndsWhenInterrupted) {
  const test::TemporaryFolder folder;
  writeKitti(folder.path(), 3);
  ImageSequenceSource source(readImageFolder(folder.path()).left);
  source.interrupt();
  Frame frame;
  EXPECT_EQ(source.read(frame, kAtOnce), ReadOutcome::ended);
}

TEST(ImageFolder, ErrorNamesFileAndProblem) {
  const test::TemporaryFolder folder;
  writeKitti(folder.path(), 4);
  fs::remove(folder / "image_1/000002.png");
  EXPECT_THAT(readError(folder.path()),
              HasSubstr("image_0/000002.png has no partner among the right images."));
  fs::remove(folder / "image_0/000002.png");
  EXPECT_THAT(readError(folder.path()), HasSubstr("image_0 contains 3 images, but"));
  EXPECT_THAT(readError(folder.path()), HasSubstr("has 4 instants, the first one missing is 000002.png"));

  writeText(folder / "times.txt", "0.1\n0.2\n0.2\n0.3\n");
  EXPECT_THAT(readError(folder.path()),
              HasSubstr("times.txt, line 3: the instant is that of the previous line again"));
  writeText(folder / "times.txt", "0.1\n0.2 x\n");
  EXPECT_THAT(readError(folder.path()), HasSubstr("times.txt, line 2: expected one number (seconds)"));
  writeText(folder / "times.txt", "-8e9\n8e9\n");  // their difference overflows
  EXPECT_THAT(readError(folder.path()), HasSubstr("times.txt, line 1: expected one number (seconds)"));
  fs::remove(folder / "times.txt");
  EXPECT_THAT(readError(folder.path()),
              HasSubstr("contains neither times.txt nor both times_0.txt and times_1.txt"));
}

TEST(ImageFolder, RejectsFolderWithoutImages) {
  const test::TemporaryFolder folder;
  fs::create_directories(folder / "image_0");
  fs::create_directories(folder / "image_1");
  writeText(folder / "times.txt", "");
  EXPECT_THAT(readError(folder.path()),
              HasSubstr("image_0 contains no image (PNG, JPEG, PGM, PPM, BMP, TIFF, WebP); it is empty"));
}

TEST(ImageFolder, ErrorNamesUnreadableOrMissizedImage) {
  const test::TemporaryFolder folder;
  writeKitti(folder.path(), 3);
  writeText(folder / "image_0/000001.png", "this is no picture");
  writePicture(folder / "image_1/000001.png", {30, 24}, 0);
  const ImageFolder read = readImageFolder(folder.path());
  Frame frame;
  ImageSequenceSource left(read.left);
  left.read(frame, kAtOnce);
  EXPECT_THAT(test::messageOf([&] { left.read(frame, kAtOnce); }),
              HasSubstr("expected a complete file in one of the formats PNG, JPEG"));
  EXPECT_THAT(test::messageOf([&] { left.read(frame, kAtOnce); }), HasSubstr("image_0/000001.png"));
  ImageSequenceSource right(read.right);
  right.read(frame, kAtOnce);
  EXPECT_THAT(test::messageOf([&] { right.read(frame, kAtOnce); }),
              HasSubstr("image_1/000001.png is 30x24, but the previous images are 32x24"));
}

TEST(ImageFolder, ErrorNamesLineOfEurocList) {
  const test::TemporaryFolder folder;
  writeEuroc(folder.path(), 2);
  const fs::path list = folder / "cam0/data.csv";
  writeText(list, "#timestamp [ns],filename\n17,gone.png\n");
  EXPECT_THAT(readError(folder.path()), HasSubstr("data.csv, line 2: "));
  EXPECT_THAT(readError(folder.path()), HasSubstr("gone.png is missing"));
  writeText(list, "17\n");
  EXPECT_THAT(readError(folder.path()), HasSubstr("line 1: expected 'instant in ns,file name'"));
  writeText(list, "17,../../../etc/passwd\n");
  EXPECT_THAT(readError(folder.path()), HasSubstr("must be the name of a file in data/"));
  for (const char* instant : {"-9223372036854775808", "9223372036854775807"}) {
    writeText(list, std::string(instant) + ",17.png\n");  // their difference overflows
    EXPECT_THAT(readError(folder.path()), HasSubstr("line 1: expected 'instant in ns,file name'"));
  }
  writeText(list, "# nothing\n");
  EXPECT_THAT(readError(folder.path()), HasSubstr("lists no image"));
}

/// Moves an image to another name.
void rename(const fs::path& folder, const std::string& from, const std::string& to) {
  fs::rename(folder / from, folder / to);
}

TEST(ImageFolder, OrdersNumbersByValueAndRefusesTwoImagesOfOneName) {
  const test::TemporaryFolder folder;
  writeKitti(folder.path(), 3);
  for (const char* camera : {"image_0", "image_1"}) {
    rename(folder / camera, "000000.png", "frame2.png");
    rename(folder / camera, "000001.png", "frame10.png");
    rename(folder / camera, "000002.png", "frame100.png");
  }
  const ImageFolder read = readImageFolder(folder.path());
  EXPECT_EQ(read.left.images[1], folder / "image_0/frame10.png");
  EXPECT_EQ(read.right.images[2], folder / "image_1/frame100.png");
  writePicture(folder / "image_1/frame010.jpg", {32, 24}, 0);
  EXPECT_THAT(readError(folder.path()),
              HasSubstr("image_1 contains two images of one name: frame010.jpg and frame10.png"));
}

TEST(ImageFolder, PairsByNames) {
  const test::TemporaryFolder folder;
  writeKitti(folder.path(), 3);
  for (const auto& [camera, side] : {std::pair("image_0", "left_"), std::pair("image_1", "right_")}) {
    for (const char* number : {"000000", "000001", "000002"})
      rename(folder / camera, std::string(number) + ".png", std::string(side) + number + ".png");
  }
  EXPECT_EQ(readImageFolder(folder.path()).right.images[2], folder / "image_1/right_000002.png");
  rename(folder / "image_0", "left_000001.png", "left_7.png");
  EXPECT_THAT(readError(folder.path()),
              HasSubstr("image_0/left_7.png has no partner among the right images, and "));
  EXPECT_THAT(readError(folder.path()),
              HasSubstr("image_1/right_000001.png has no partner among the left images. "));
}

TEST(ImageFolder, LeavesOutHiddenAndOtherFiles) {
  const test::TemporaryFolder folder;
  writeKitti(folder.path(), 2);
  writeText(folder / "image_0/._000000.png", "note of macOS");
  writeText(folder / "image_0/.DS_Store", "");
  writeText(folder / "image_1/Thumbs.db", "");
  EXPECT_EQ(readImageFolder(folder.path()).left.images.size(), 2U);
}

TEST(ImageFolder, ReadsColourImagesOfKitti) {
  const test::TemporaryFolder folder;
  writeKitti(folder.path(), 2);
  fs::rename(folder / "image_0", folder / "image_2");
  fs::rename(folder / "image_1", folder / "image_3");
  const ImageFolder read = readImageFolder(folder.path());
  EXPECT_EQ(read.cameras, (std::array{2, 3}));
  EXPECT_EQ(read.left.images[0], folder / "image_2/000000.png");
}

TEST(ImageFolder, ReadsRawRecordingsOfKitti) {
  const test::TemporaryFolder folder;
  const fs::path drive = folder / "2011_09_26/drive_0001";
  for (const char* camera : {"image_00", "image_01"}) {
    writePicture(drive / camera / "data/0000000000.png", {32, 24}, 1);
    writePicture(drive / camera / "data/0000000001.png", {32, 24}, 2);
    writeText(drive / camera / "timestamps.txt", "2011-09-26 13:02:25.594360375\n2011-09-26 13:02:26\n");
  }
  writeText(folder / "2011_09_26/calib_cam_to_cam.txt", "P_rect_00: 1\n");
  const ImageFolder read = readImageFolder(drive);
  EXPECT_EQ(read.layout, FolderLayout::kitti_raw);
  EXPECT_EQ(read.left.instants_ns, (std::vector<std::int64_t>{1317042145594360375, 1317042146000000000}));
  EXPECT_EQ(read.calib_file, folder / "2011_09_26/calib_cam_to_cam.txt");
  writeText(drive / "image_01/timestamps.txt", "2011-09-26 13:02:25.5\n13:02:26.1\n");
  EXPECT_THAT(readError(drive),
              HasSubstr("timestamps.txt, line 2: expected a date and a time such as 2011-"));
}

TEST(ImageFolder, RefusesIntervalsThatAreNoCamerasNamingTheUnit) {
  const test::TemporaryFolder folder;
  writeKitti(folder.path(), 3);
  writeText(folder / "times.txt", "0\n55\n111\n");
  EXPECT_THAT(
      readError(folder.path()),
      HasSubstr("times.txt: the instants are read as seconds, and the median of their intervals is 55 s; "
                "expected a camera's, 0.001 s to 2 s. In milliseconds they would be 0.055 s: convert the "
                "instants from milliseconds to seconds"));
  writeText(folder / "times.txt", "0\n55000\n111000\n");
  EXPECT_THAT(readError(folder.path()), HasSubstr("In microseconds they would be 0.055 s"));
  writeText(folder / "times.txt", "0\n55000000\n111000000\n");
  EXPECT_THAT(readError(folder.path()), HasSubstr("In nanoseconds they would be 0.055 s"));
  writeEuroc(folder / "euroc", 2);
  fs::rename(folder / "euroc/cam0/data/1403715273262142976.png", folder / "euroc/cam0/data/a.png");
  fs::rename(folder / "euroc/cam0/data/1403715273312142976.png", folder / "euroc/cam0/data/b.png");
  writeText(folder / "euroc/cam0/data.csv", "1403715273262142,a.png\n1403715273312142,b.png\n");
  EXPECT_THAT(readError(folder / "euroc"), HasSubstr("In microseconds they would be 0.05 s"));
  writeText(folder / "times.txt", "0\n1\n2\n");
  EXPECT_THAT(readError(folder.path()), testing::IsEmpty()) << "1 Hz";
}

TEST(ImageFolder, WarnsOfInstantsThatAreFrameNumbers) {
  const test::TemporaryFolder folder;
  writeKitti(folder.path(), 6);
  writeText(folder / "times.txt", "0\n1\n2\n3\n4\n5\n");
  EXPECT_THAT(readImageFolder(folder.path()).warnings, testing::ElementsAre(HasSubstr("like frame numbers")));
}

TEST(ImageFolder, TakesInstantsFromNumbersAndAFrameRate) {
  const test::TemporaryFolder folder;
  writeKitti(folder.path(), 4);
  for (const char* camera : {"image_0", "image_1"})
    fs::remove(folder / camera / "000001.png");
  fs::remove(folder / "times.txt");
  const ImageFolder read = readImageFolder(folder.path(), {.frame_rate = 20.0});
  EXPECT_EQ(read.right.instants_ns, (std::vector<std::int64_t>{0, 100000000, 150000000}));
  EXPECT_THAT(readError(folder.path()), HasSubstr("give --frame-rate HZ"));
}

TEST(ImageFolder, ReadsInstantsWithAByteOrderMark) {
  const test::TemporaryFolder folder;
  writeKitti(folder.path(), 2);
  writeText(folder / "times.txt",
            "\xEF\xBB\xBF"
            "0.5\r\n0.6\r\n");
  EXPECT_EQ(readImageFolder(folder.path()).left.instants_ns[0], 500000000);
}

TEST(ImageFolder, DividesTwelveBitsInSixteenByOneFactor) {
  const test::TemporaryFolder folder;
  for (const char* camera : {"image_0", "image_1"}) {
    for (int i = 0; i < 3; ++i) {
      const fs::path file = folder / camera / (std::to_string(i) + ".png");
      fs::create_directories(file.parent_path());
      // Only one image of one camera shows the brightest value.
      const int brightest = i == 2 && camera == std::string("image_1") ? 4095 : 900;
      cv::Mat image(24, 32, CV_16UC1, cv::Scalar(800));
      image.at<std::uint16_t>(0, 0) = static_cast<std::uint16_t>(brightest);
      ASSERT_TRUE(cv::imwrite(file.string(), image));
    }
  }
  writeText(folder / "times.txt", "0.1\n0.2\n0.3\n");
  const ImageFolder read = readImageFolder(folder.path());
  EXPECT_THAT(read.warnings, testing::ElementsAre(HasSubstr("the 16-bit images use 12 bits")));
  for (const ImageSequence& sequence : {read.left, read.right}) {
    ImageSequenceSource source(sequence);
    Frame frame;
    while (source.read(frame, kAtOnce) == ReadOutcome::frame)
      EXPECT_EQ(frame.image.at<std::uint8_t>(5, 5), 50);
  }
}

TEST(StereoSource, DetectsKindOfFolder) {
  const test::TemporaryFolder folder;
  writeKitti(folder / "kitti", 3);
  writeEuroc(folder / "euroc/mav0", 2);
  fs::create_directories(folder / "other");
  const StereoSource kitti = openSource(folder / "kitti");
  EXPECT_EQ(kitti.kind, SourceKind::kitti);
  EXPECT_EQ(kitti.pairs, 3U);
  EXPECT_EQ(kitti.period_ns, 100000000);
  EXPECT_FALSE(kitti.calib_file.empty());
  const StereoSource euroc = openSource(folder / "euroc");
  EXPECT_EQ(euroc.kind, SourceKind::euroc);
  EXPECT_FALSE(euroc.sensor_files[0].empty());

  const std::string error = test::messageOf([&] { openSource(folder / "other"); });
  EXPECT_THAT(error, HasSubstr("Looked for: a recording (recording.json"));
  EXPECT_THAT(error, HasSubstr("KITTI's layout (image_0 and image_1, "));
  EXPECT_THAT(error, HasSubstr("EuRoC's and TUM-VI's layout (cam0 and cam1"));
  EXPECT_THAT(test::messageOf([&] { openSource(folder / "nowhere"); }), HasSubstr("does not exist"));
}

TEST(StereoSource, OpensRealSequences) {
  CARTVO_NEEDS_DATA(kitti, "kitti_06");
  CARTVO_NEEDS_DATA(euroc, "euroc_still");
  StereoSource source = openSource(kitti);
  EXPECT_EQ(source.pairs, 51U);
  Frame frame;
  ASSERT_EQ(source.right->read(frame, kAtOnce), ReadOutcome::frame);
  EXPECT_EQ(frame.image.size(), cv::Size(1226, 370));
  EXPECT_EQ(openSource(euroc).pairs, 40U);
}

}  // namespace
}  // namespace cartvo::capture
