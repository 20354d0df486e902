// Image folders in KITTI's and EuRoC's layouts.

#include "capture/dataset/image_folder.hpp"

#include <fstream>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "capture/stereo_source.hpp"
#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_data.hpp"

namespace cartvo::capture {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr std::chrono::milliseconds kAtOnce{0};
constexpr char kCalibration[] =
    "P0: 700 0 320 0 0 700 240 0 0 0 1 0\nP1: 700 0 320 -80.5 0 700 240 0 0 0 1 0\n";

void write(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

void writeImage(const fs::path& file, cv::Size size, int grey) {
  fs::create_directories(file.parent_path());
  ASSERT_TRUE(cv::imwrite(file.string(), cv::Mat(size, CV_8UC1, cv::Scalar(grey))));
}

void writeKitti(const fs::path& folder, int count) {
  std::string times;
  for (int i = 0; i < count; ++i) {
    char name[16];
    std::snprintf(name, sizeof(name), "%06d.png", i);
    writeImage(folder / "image_0" / name, {32, 24}, i);
    writeImage(folder / "image_1" / name, {32, 24}, 100 + i);
    times += std::to_string(i) + ".5e-01\n";
  }
  write(folder / "times.txt", times);
  write(folder / "calib.txt", kCalibration);
}

void writeEuroc(const fs::path& folder, int count) {
  for (const char* camera : {"cam0", "cam1"}) {
    std::string list = "#timestamp [ns],filename\r\n";
    for (int i = 0; i < count; ++i) {
      const std::string instant = std::to_string(1403715273262142976 + i * 50000000LL);
      writeImage(folder / camera / "data" / (instant + ".png"), {32, 24}, i);
      list.append(instant).append(",").append(instant).append(".png\r\n");
    }
    write(folder / camera / "data.csv", list);
    write(folder / camera / "sensor.yaml", "sensor_type: camera\n");
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
  ASSERT_TRUE(read.rectified);
  EXPECT_DOUBLE_EQ(read.rectified->focal_length, 700.0);
  EXPECT_DOUBLE_EQ(read.rectified->baseline, 80.5 / 700.0);
  EXPECT_DOUBLE_EQ(read.rectified->cx, 320.0);
  EXPECT_DOUBLE_EQ(read.rectified->cy, 240.0);
  EXPECT_TRUE(read.rig_file.empty());
}

TEST(ImageFolder, PrefersTimesOfEachCamera) {
  const test::TemporaryFolder folder;
  writeKitti(folder.path(), 3);
  write(folder / "times_0.txt", "1\n2\n3\n");
  write(folder / "times_1.txt", "1.025\n2.025\n3.025\n");
  write(folder / "rig.yaml", "rig\n");
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
    EXPECT_FALSE(read.rectified);
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
  EXPECT_THAT(readError(folder.path()), HasSubstr("image_1 contains 3 images, but"));
  EXPECT_THAT(readError(folder.path()), HasSubstr("has 4 instants, the first one missing is 000002.png"));

  write(folder / "times.txt", "0.1\n0.2\n0.2\n0.3\n");
  EXPECT_THAT(readError(folder.path()),
              HasSubstr("times.txt, line 3: the instant is not later than the previous one"));
  write(folder / "times.txt", "0.1\n0.2 x\n");
  EXPECT_THAT(readError(folder.path()), HasSubstr("times.txt, line 2: expected one number (seconds)"));
  write(folder / "times.txt", "-8e9\n8e9\n");  // their difference overflows
  EXPECT_THAT(readError(folder.path()), HasSubstr("times.txt, line 1: expected one number (seconds)"));
  fs::remove(folder / "times.txt");
  EXPECT_THAT(readError(folder.path()),
              HasSubstr("contains neither times.txt nor both times_0.txt and times_1.txt"));
}

TEST(ImageFolder, FindsGapAmongLargestNumbers) {
  const test::TemporaryFolder folder;
  writeKitti(folder.path(), 1);
  write(folder / "image_0/9223372036854775807.jpg", "");
  write(folder / "image_0/9223372036854775807.png", "");
  write(folder / "times.txt", "0.1\n0.2\n0.3\n0.4\n");
  EXPECT_THAT(readError(folder.path()), HasSubstr("the first one missing is 0000000000000000001.jpg"));
}

TEST(ImageFolder, RejectsFolderWithoutImages) {
  const test::TemporaryFolder folder;
  fs::create_directories(folder / "image_0");
  fs::create_directories(folder / "image_1");
  write(folder / "times.txt", "");
  EXPECT_THAT(readError(folder.path()), HasSubstr("image_0 contains no PNG or JPEG image"));
}

TEST(ImageFolder, RejectsInvalidCalibration) {
  const test::TemporaryFolder folder;
  writeKitti(folder.path(), 2);
  const auto with = [&](const std::string& text) {
    write(folder / "calib.txt", text);
    return readError(folder.path());
  };
  EXPECT_THAT(with("P0: 1 2 3\n"),
              HasSubstr("calib.txt, line 1: expected 12 numbers (3 rows of 4), found 3"));
  EXPECT_THAT(with("P0: 700 0 320 0 0 700 240 0 0 0 1 zero\n"), HasSubstr("line 1: 'zero' is not a number"));
  EXPECT_THAT(with("P0: 700 0 320 0 0 700 240 0 0 0 1 0\n"),
              HasSubstr("must contain the matrices P0: and P1:"));
  EXPECT_THAT(with("P0: 700 0 320 0 0 700 240 0 0 0 1 0\nP1: 700 0 320 80 0 700 240 0 0 0 1 0\n"),
              HasSubstr("places the right camera to the left"));
  EXPECT_THAT(with("P0: 700 0 320 1e308 0 700 240 0 0 0 1 0\nP1: 700 0 320 -1e308 0 700 240 0 0 0 1 0\n"),
              HasSubstr("the baseline from P0 and P1 is not finite"));
  EXPECT_THAT(with("P0: 700 0 320 0 0 700 240 0 0 0 1 0\nP1: 650 0 320 -80 0 650 240 0 0 0 1 0\n"),
              HasSubstr("not those of rectified cameras"));
}

TEST(ImageFolder, ErrorNamesUnreadableOrMissizedImage) {
  const test::TemporaryFolder folder;
  writeKitti(folder.path(), 3);
  write(folder / "image_0/000001.png", "this is no picture");
  writeImage(folder / "image_1/000001.png", {30, 24}, 0);
  const ImageFolder read = readImageFolder(folder.path());
  Frame frame;
  ImageSequenceSource left(read.left);
  left.read(frame, kAtOnce);
  EXPECT_THAT(test::messageOf([&] { left.read(frame, kAtOnce); }),
              HasSubstr("expected a complete PNG or JPEG file"));
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
  write(list, "#timestamp [ns],filename\n17,gone.png\n");
  EXPECT_THAT(readError(folder.path()), HasSubstr("data.csv, line 2: "));
  EXPECT_THAT(readError(folder.path()), HasSubstr("gone.png is missing"));
  write(list, "17\n");
  EXPECT_THAT(readError(folder.path()), HasSubstr("line 1: expected 'instant in ns,file name'"));
  write(list, "17,../../../etc/passwd\n");
  EXPECT_THAT(readError(folder.path()), HasSubstr("must be the name of a file in data/"));
  for (const char* instant : {"-9223372036854775808", "9223372036854775807"}) {
    write(list, std::string(instant) + ",17.png\n");  // their difference overflows
    EXPECT_THAT(readError(folder.path()), HasSubstr("line 1: expected 'instant in ns,file name'"));
  }
  write(list, "# nothing\n");
  EXPECT_THAT(readError(folder.path()), HasSubstr("lists no image"));
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
  EXPECT_TRUE(kitti.rectified);
  const StereoSource euroc = openSource(folder / "euroc");
  EXPECT_EQ(euroc.kind, SourceKind::euroc);
  EXPECT_FALSE(euroc.sensor_files[0].empty());

  const std::string error = test::messageOf([&] { openSource(folder / "other"); });
  EXPECT_THAT(error, HasSubstr("Looked for: a recording (recording.json"));
  EXPECT_THAT(error, HasSubstr("KITTI's layout (image_0, image_1, times.txt)"));
  EXPECT_THAT(error, HasSubstr("EuRoC's layout (cam0 and cam1"));
  EXPECT_THAT(test::messageOf([&] { openSource(folder / "nowhere"); }), HasSubstr("does not exist"));
}

TEST(StereoSource, OpensRealSequences) {
  CARTVO_NEEDS_DATA(kitti, "kitti_06");
  CARTVO_NEEDS_DATA(euroc, "euroc_still");
  StereoSource source = openSource(kitti);
  EXPECT_EQ(source.pairs, 51U);
  EXPECT_NEAR(source.rectified->baseline, 0.537, 0.001);
  Frame frame;
  ASSERT_EQ(source.right->read(frame, kAtOnce), ReadOutcome::frame);
  EXPECT_EQ(frame.image.size(), cv::Size(1226, 370));
  EXPECT_EQ(openSource(euroc).pairs, 40U);
}

}  // namespace
}  // namespace cartvo::capture
