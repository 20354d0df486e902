// Image folders as data sets and cameras come: a small sample of each layout.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/dataset/image_folder.hpp"
#include "capture/pair_synchroniser.hpp"
#include "capture/stereo_source.hpp"
#include "support/capture/written_files.hpp"
#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"

namespace cartvo::capture {
namespace {

namespace fs = std::filesystem;
using test::writePicture;
using test::writeText;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const cv::Size kSize{32, 24};

std::string readError(const fs::path& folder, const ImageFolderSettings& settings = {}) {
  return test::messageOf([&] { readImageFolder(folder, settings); });
}

std::vector<std::string> namesOf(const ImageSequence& sequence) {
  std::vector<std::string> names;
  for (const fs::path& image : sequence.images)
    names.push_back(image.filename().string());
  return names;
}

/// The grey levels of all images that a source delivers.
std::vector<int> greysOf(const ImageSequence& sequence) {
  ImageSequenceSource source(sequence);
  std::vector<int> greys;
  Frame frame;
  while (source.read(frame, std::chrono::milliseconds{0}) == ReadOutcome::frame)
    greys.push_back(frame.image.at<std::uint8_t>(5, 5));
  return greys;
}

TEST(NewCollege, HasInstantsInTheNamesOfOneFolder) {
  const test::TemporaryFolder folder;
  // Irregular instants, and a right image that is missing.
  const std::vector<std::string> instants{"1225719884.662058", "1225719884.712001", "1225719884.790900"};
  for (std::size_t i = 0; i < instants.size(); ++i) {
    const std::string name = "StereoImage__" + instants[i];
    writePicture(folder / "StereoImages" / (name + "-left.pnm"), kSize, 10 * static_cast<int>(i));
    if (i != 1) writePicture(folder / "StereoImages" / (name + "-right.pnm"), kSize, 100);
  }
  writeText(folder / "rig.yaml", "rig\n");
  for (const fs::path& path : {folder.path(), folder / "StereoImages"}) {
    const ImageFolder read = readImageFolder(path);
    EXPECT_EQ(read.layout, FolderLayout::one_folder);
    EXPECT_THAT(read.left.instants_ns,
                ElementsAre(1225719884662058000, 1225719884712001000, 1225719884790900000));
    EXPECT_THAT(read.right.instants_ns, ElementsAre(1225719884662058000, 1225719884790900000));
    EXPECT_THAT(greysOf(read.left), ElementsAre(0, 10, 20));
  }
  EXPECT_EQ(readImageFolder(folder.path()).rig_file, folder / "rig.yaml");
}

TEST(NewCollege, HasInstantsInTheNamesOfTwoFolders) {
  const test::TemporaryFolder folder;
  for (const char* side : {"left", "right"}) {
    for (const char* name : {"1225719884.95", "1225719885.000001"})
      writePicture(folder / side / (std::string(name) + ".png"), kSize, 1);
  }
  const ImageFolder read = readImageFolder(folder.path());
  EXPECT_EQ(read.layout, FolderLayout::kitti);
  EXPECT_THAT(read.right.instants_ns, ElementsAre(1225719884950000000, 1225719885000001000));
  writePicture(folder / "left/1225719884.950.png", kSize, 1);
  EXPECT_THAT(readError(folder.path()),
              HasSubstr("has the instant of 1225719884.95.png in its name; expected instants that differ"));
  fs::remove(folder / "left/1225719884.950.png");
  writePicture(folder / "left/latest.png", kSize, 1);
  EXPECT_THAT(readError(folder.path()),
              HasSubstr("nor have the images instants in their names, such as 1225719884.662058.png"));
}

TEST(NewCollege, MayHaveIntegersInTheNames) {
  const test::TemporaryFolder folder;
  for (const char* camera : {"cam0", "cam1"}) {
    writePicture(folder / (std::string("1225719884662_") + camera + ".jpg"), kSize, 1);
    writePicture(folder / (std::string("1225719884712_") + camera + ".jpg"), kSize, 1);
  }
  EXPECT_THAT(readImageFolder(folder.path()).left.instants_ns,
              ElementsAre(1225719884662000000, 1225719884712000000));
  writePicture(folder / "1225719990000_cam0.jpg", kSize, 1);
  writePicture(folder / "1225719999000_cam0.jpg", kSize, 1);
  writePicture(folder / "1225720999000_cam0.jpg", kSize, 1);
  EXPECT_THAT(readError(folder.path()), HasSubstr("expected a camera's, 0.001 s to 2 s"));
}

TEST(Malaga, IsOneFolderOfBothCameras) {
  const test::TemporaryFolder folder;
  const fs::path images = folder / "malaga-urban-dataset-extract-07_rectified_800x600_Images";
  for (const char* side : {"left", "right"}) {
    for (const char* instant : {"1261229981.580023", "1261229981.630019"})
      writePicture(images / ("img_CAMERA1_" + std::string(instant) + "_" + side + ".jpg"), kSize, 1);
  }
  const ImageFolder read = readImageFolder(folder.path());
  EXPECT_THAT(read.right.instants_ns, ElementsAre(1261229981580023000, 1261229981630019000));
  EXPECT_THAT(read.warnings, ElementsAre(HasSubstr("the images are dark")));
}

TEST(Karlsruhe, IsNumberedAndNeedsTimes) {
  const test::TemporaryFolder folder;
  for (const char* camera : {"I1_", "I2_"}) {
    for (const char* number : {"000000", "000001", "000003"})
      writePicture(folder / (std::string(camera) + number + ".png"), kSize, 1);
  }
  EXPECT_THAT(readError(folder.path()), HasSubstr("at a fixed rate give --frame-rate HZ"));
  const ImageFolder at_rate = readImageFolder(folder.path(), {.frame_rate = 10.0});
  EXPECT_THAT(at_rate.right.instants_ns, ElementsAre(0, 100000000, 300000000)) << "a number is missing";
  EXPECT_THAT(namesOf(at_rate.right), ElementsAre("I2_000000.png", "I2_000001.png", "I2_000003.png"));
  writeText(folder / "times.txt", "0.0\n0.1\n0.35\n");
  EXPECT_THAT(readImageFolder(folder.path()).left.instants_ns, ElementsAre(0, 100000000, 350000000));
  writeText(folder / "times.txt", "0.0\n0.1\n");
  EXPECT_THAT(readError(folder.path()), HasSubstr("contains 3 images, but "));
}

TEST(Zed, ExportsNumberedPicturesOfBothSides) {
  const test::TemporaryFolder folder;
  for (const char* number : {"000000", "000001"}) {
    writePicture(folder / (std::string("left") + number + ".png"),
                 cv::Mat(kSize, CV_8UC3, cv::Scalar::all(90)));
    writePicture(folder / (std::string("right") + number + ".png"),
                 cv::Mat(kSize, CV_8UC3, cv::Scalar::all(70)));
    writePicture(folder / (std::string("depth") + number + ".png"), kSize, 200);
  }
  const ImageFolder read = readImageFolder(folder.path(), {.frame_rate = 30.0});
  EXPECT_THAT(namesOf(read.left), ElementsAre("left000000.png", "left000001.png"));
  EXPECT_THAT(greysOf(read.left), ElementsAre(90, 90)) << "of colour images";
  EXPECT_THAT(greysOf(read.right), ElementsAre(70, 70));
  EXPECT_THAT(read.warnings, ElementsAre(HasSubstr("2 images whose names name neither the left nor")));
  fs::remove(folder / "right000001.png");
  EXPECT_THAT(readError(folder.path(), {.frame_rate = 30.0}),
              HasSubstr("left000001.png has no partner among the right images"));
}

TEST(SideBySide, TakesTheHalvesOfEachPicture) {
  const test::TemporaryFolder folder;
  for (const char* number : {"1", "2", "10"}) {
    cv::Mat both(24, 64, CV_8UC1, cv::Scalar(100 + std::atoi(number)));
    both.colRange(32, 64).setTo(50);
    writePicture(folder / "images" / (std::string(number) + ".bmp"), both);
  }
  writeText(folder / "calib.txt", "P0: 1\n");
  const ImageFolder read = readImageFolder(folder.path(), {.frame_rate = 10.0, .side_by_side = true});
  EXPECT_THAT(greysOf(read.left), ElementsAre(101, 102, 110));
  EXPECT_THAT(greysOf(read.right), ElementsAre(50, 50, 50));
  EXPECT_EQ(read.calib_file, folder / "calib.txt");
  ImageSequenceSource source(read.right);
  Frame frame;
  source.read(frame, std::chrono::milliseconds{0});
  EXPECT_EQ(frame.image.size(), kSize);
  EXPECT_THAT(readError(folder.path()), HasSubstr("give --side-by-side for images"));
  EXPECT_THAT(readError(folder / "images", {.side_by_side = true}), HasSubstr("give --frame-rate HZ"));
  fs::create_directories(folder / "empty");
  EXPECT_THAT(readError(folder / "empty", {.side_by_side = true}),
              HasSubstr("--side-by-side expects images"));
}

TEST(Lists, GiveAnInstantAndAnImageALine) {
  const test::TemporaryFolder folder;
  for (const char* name : {"a/1.png", "a/2.png", "b/1.png"})
    writePicture(folder / name, kSize, 1);
  writeText(folder / "left.txt", "# instant file\n0.5 a/1.png\n0.61,a/2.png\n");
  writeText(folder / "right.txt", "1700000000000000000 b/1.png\n");
  const ImageFolder read = readImageFolder(folder.path());
  EXPECT_EQ(read.layout, FolderLayout::lists);
  EXPECT_THAT(read.left.instants_ns, ElementsAre(500000000, 610000000));
  EXPECT_THAT(read.right.instants_ns, ElementsAre(1700000000000000000)) << "counts may differ";
  writeText(folder / "right.txt", "0.5 b/gone.png\n");
  EXPECT_THAT(readError(folder.path()), HasSubstr("right.txt, line 1: "));
  EXPECT_THAT(readError(folder.path()), HasSubstr("gone.png is missing"));
  writeText(folder / "right.txt", "b/1.png 0.5\n");
  EXPECT_THAT(readError(folder.path()), HasSubstr("right.txt, line 1: expected an instant (seconds, or ns"));
  for (const char* outside : {"../x.png", "/etc/passwd", "a/../../x.png"}) {
    writeText(folder / "right.txt", std::string("0.5 ") + outside + "\n");
    EXPECT_THAT(readError(folder.path()), HasSubstr("must be a path in the folder of the list"));
  }
  writeText(folder / "right.txt", "\n");
  EXPECT_THAT(readError(folder.path()), HasSubstr("right.txt lists no image"));
  writeText(folder / "left.txt", "1403636579763555 a/1.png\n1403636579813555 a/2.png\n");
  EXPECT_THAT(readError(folder.path()),
              HasSubstr("the instants are read as nanoseconds, and the median of their intervals is 5e-05 s; "
                        "expected a camera's, 0.001 s to 2 s. In microseconds they would be 0.05 s"));
  EXPECT_THAT(readError(folder.path(), {.frame_rate = 10.0}), HasSubstr("has the instants of its images"));
}

TEST(TumVi, HasTheRigOfKalibr) {
  const test::TemporaryFolder folder;
  for (const char* camera : {"cam0", "cam1"}) {
    const fs::path images = folder / "mav0" / camera;
    cv::Mat image(kSize, CV_16UC1, cv::Scalar(0x4040));
    writePicture(images / "data/1520530308199447626.png", image);
    writePicture(images / "data/1520530308249448626.png", image);
    writeText(images / "data.csv",
              "#timestamp [ns],filename\n1520530308199447626,1520530308199447626.png\n"
              "1520530308249448626,1520530308249448626.png\n");
  }
  writeText(folder / "dso/camchain.yaml", "cam0:\n");
  const ImageFolder read = readImageFolder(folder.path());
  EXPECT_EQ(read.layout, FolderLayout::euroc);
  EXPECT_EQ(read.calib_file, folder / "dso/camchain.yaml");
  EXPECT_TRUE(read.sensor_files[0].empty());
  EXPECT_THAT(greysOf(read.left), ElementsAre(0x40, 0x40)) << "16 bits";
}

TEST(ImageFormats, AreGreyOfEightBits) {
  const test::TemporaryFolder folder;
  const cv::Mat grey(kSize, CV_8UC1, cv::Scalar(77)), colour(kSize, CV_8UC3, cv::Scalar::all(77)),
      deep(kSize, CV_16UC1, cv::Scalar(77 * 256)), deep_colour(kSize, CV_16UC3, cv::Scalar::all(77 * 256));
  const std::vector<std::pair<std::string, cv::Mat>> images{
      {"grey.png", grey},     {"grey.pgm", grey},     {"grey.jpg", grey},        {"grey.bmp", grey},
      {"grey.tiff", grey},    {"grey.TIF", grey},     {"grey.webp", grey},       {"colour.png", colour},
      {"colour.ppm", colour}, {"colour.pnm", colour}, {"colour.jpeg", colour},   {"colour.bmp", colour},
      {"deep.png", deep},     {"deep.pgm", deep},     {"deep.png", deep_colour}, {"deep.tiff", deep}};
  for (const auto& [name, image] : images) {
    const fs::path drive = folder / (name + std::to_string(image.type()));
    for (const char* camera : {"image_0", "image_1"})
      writePicture(drive / camera / name, image);
    writeText(drive / "times.txt", "0.5\n");
    EXPECT_THAT(greysOf(readImageFolder(drive).left),
                ElementsAre(testing::AllOf(testing::Ge(76), testing::Le(78))))
        << name;
  }
}

TEST(UnlikeCameras, ArePairedByTheirInstants) {
  const test::TemporaryFolder folder;
  // Irregular instants; each camera has lost an image that the other one has.
  for (const char* instant : {"1700000000.00", "1700000000.05", "1700000000.12", "1700000000.20"})
    writePicture(folder / "left" / (std::string(instant) + ".png"), kSize, 1);
  for (const char* instant : {"1700000000.001", "1700000000.121", "1700000000.201"})
    writePicture(folder / "right" / (std::string(instant) + ".png"), kSize, 1);
  const StereoSource source = openSource(folder.path());
  EXPECT_EQ(source.pairs, 3U);
  EXPECT_EQ(source.period_ns, 70000000);
}

TEST(NoLayout, ListsWhatWasLookedFor) {
  const test::TemporaryFolder folder;
  writePicture(folder / "one.png", kSize, 1);
  for (const char* layout : {"image_0 and image_1", "image_00/data", "EuRoC's and TUM-VI's",
                             "left.txt and right.txt", "StereoImages", "--side-by-side"}) {
    EXPECT_THAT(readError(folder.path()), HasSubstr(layout));
    EXPECT_THAT(test::messageOf([&] { openSource(folder.path()); }), HasSubstr(layout));
  }
}

}  // namespace
}  // namespace cartvo::capture
