// Tests of rendered image folders and of recorded sequences as content.
#include "tools/simulate/content_files.hpp"

#include <fstream>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "calib/format/rig_file.hpp"
#include "support/error_message.hpp"
#include "support/pattern_content.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_data.hpp"
#include "tools/simulate/sequence_content.hpp"

namespace cartvo::simulate {
namespace {

namespace fs = std::filesystem;

std::string errorOf(const fs::path& folder) {
  return test::messageOf([&] { const SequenceContent content(folder, {}); });
}

TEST(RenderFolder, ReadsBackAsTheSameContent) {
  const test::TemporaryFolder folder;
  const test::PatternContent pattern({.size = {64, 48}, .pairs = 4, .offset_s = 0.0125});
  renderFolder(folder / "drive", pattern, {});
  const SequenceContent read(folder / "drive", {});

  ASSERT_EQ(read.pairCount(), pattern.pairCount());
  EXPECT_NEAR(read.frameRate(), pattern.frameRate(), 1e-6);
  EXPECT_NEAR(read.rig().baseline(), pattern.rig().baseline(), 1e-12);
  EXPECT_TRUE(fs::exists(folder / "drive" / "calib.txt"));  // the pattern's cameras are rectified
  cv::Mat left;
  cv::Mat right;
  cv::Mat read_left;
  cv::Mat read_right;
  for (int index = 0; index < read.pairCount(); ++index) {
    EXPECT_EQ(read.leftInstant(index), pattern.leftInstant(index));
    EXPECT_EQ(read.rightInstant(index), pattern.rightInstant(index));
    pattern.images(index, left, right);
    read.images(index, read_left, read_right);
    EXPECT_EQ(cv::norm(left, read_left, cv::NORM_INF), 0.0);
    EXPECT_EQ(cv::norm(right, read_right, cv::NORM_INF), 0.0);
  }
}

TEST(RenderFolder, WritesTheSameTruthInTwoFormats) {
  const test::TemporaryFolder folder;
  const test::PatternContent pattern({.size = {64, 48}, .pairs = 4});
  renderFolder(folder / "drive", pattern, {});
  const Trajectory body = readTrajectory(folder / "drive" / "truth.tum");
  const Trajectory camera = readTrajectory(folder / "drive" / "poses.txt");

  ASSERT_EQ(body.size(), 4U);
  ASSERT_EQ(camera.size(), 4U);
  // The motion is 0.4 m/s to the right: -y in body axes, x in camera axes.
  EXPECT_EQ(body[3].time_ns, 150'000'000);
  EXPECT_TRUE(body[3].pose.translation().isApprox(Eigen::Vector3d(0.0, -0.06, 0.0), 1e-6));
  EXPECT_TRUE(camera[3].pose.translation().isApprox(Eigen::Vector3d(0.06, 0.0, 0.0), 1e-6));
}

TEST(EarlierTruth, IsKeptByTheSecondOfItsFirstPose) {
  const test::TemporaryFolder folder;
  const test::PatternContent pattern({.size = {64, 48}, .pairs = 4});
  EXPECT_EQ(keepEarlierTruth(folder.path()), std::nullopt);
  writeTruth(folder.path(), pattern, 1'767'225'600'500'000'000);
  const Trajectory truth = readTrajectory(folder / "truth.tum");
  EXPECT_EQ(keepEarlierTruth(folder.path()), folder / "truth-1767225600.tum");
  EXPECT_FALSE(fs::exists(folder / "truth.tum"));
  EXPECT_EQ(readTrajectory(folder / "truth-1767225600.tum").size(), truth.size());
  writeTruth(folder.path(), pattern, 1'767'225'600'500'000'000);
  EXPECT_THROW(keepEarlierTruth(folder.path()), std::runtime_error) << "the name is taken";
  EXPECT_TRUE(fs::exists(folder / "truth.tum"));
}

TEST(RenderFolder, RejectsFolderThatIsNotEmpty) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "notes.txt") << "mine\n";
  EXPECT_THROW(renderFolder(folder.path(), test::PatternContent({}), {}), std::runtime_error);
  EXPECT_TRUE(fs::exists(folder / "notes.txt"));
}

TEST(SequenceContent, ErrorNamesFileAndProblem) {
  const test::TemporaryFolder folder;
  EXPECT_NE(errorOf(folder / "none").find((folder / "none").string()), std::string::npos);

  const test::PatternContent pattern({.size = {64, 48}, .pairs = 3});
  renderFolder(folder / "a", pattern, {});
  std::ofstream(folder / "a" / "poses.txt", std::ios::app) << "1 0 0 0 0 1 0 0 0 0 1 0\n";
  EXPECT_EQ(errorOf(folder / "a"), (folder / "a" / "poses.txt").string() + ": 4 poses for 3 images");

  renderFolder(folder / "b", pattern, {});
  std::ofstream(folder / "b" / "image_0" / "000000.png") << "not a picture";
  EXPECT_EQ(errorOf(folder / "b"),
            (folder / "b" / "image_0" / "000000.png").string() +
                ": cannot be decoded as an image; expected a complete file in one of the "
                "formats PNG, JPEG, PGM, PPM, BMP, TIFF, WebP; copy it again");

  renderFolder(folder / "c", pattern, {});
  fs::remove(folder / "c" / "rig.yaml");
  fs::remove(folder / "c" / "calib.txt");
  EXPECT_NE(errorOf(folder / "c"), "");
}

TEST(SequenceContent, ReadsKittiAndCropsOddColumn) {
  CARTVO_NEEDS_DATA(folder, "kitti_00");
  const SequenceContent content(folder, {.seconds = 1.0, .offset_s = 0.02});
  EXPECT_EQ(content.rig().left.size, cv::Size(1240, 376));
  EXPECT_EQ(content.rightInstant(0) - content.leftInstant(0), 20'000'000);
  EXPECT_EQ(content.truth().size(), static_cast<std::size_t>(content.pairCount()));
  cv::Mat left;
  cv::Mat right;
  content.images(0, left, right);
  EXPECT_EQ(left.size(), cv::Size(1240, 376));
}

}  // namespace
}  // namespace cartvo::simulate
