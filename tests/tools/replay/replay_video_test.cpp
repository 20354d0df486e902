// The video of a replay: written under its name only when it is complete, and its pictures.
#include <csignal>
#include <fstream>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "common/command_line/command_line_error.hpp"
#include "support/error_message.hpp"
#include "support/file_text.hpp"
#include "support/temporary_folder.hpp"
#include "tools/cartvo/interruption.hpp"
#include "tools/replay/video/mp4_writer.hpp"
#include "tools/replay/video/replay_picture.hpp"

namespace cartvo {
namespace {

using ::testing::HasSubstr;

constexpr std::int64_t kPeriod_ns = 50'000'000;

std::size_t fileCount(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

TEST(Mp4Writer, GivesTheFileItsNameWhenItIsComplete) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder / "a.mp4";
  {
    Mp4Writer writer(file);
    for (int i = 0; i < 10; ++i)
      writer.add(cv::Mat(64, 96, CV_8UC3, cv::Scalar::all(20 * i)), i * kPeriod_ns);
    EXPECT_FALSE(std::filesystem::exists(file));
    writer.finish();
  }
  EXPECT_EQ(fileCount(folder.path()), 1u);
  const std::string bytes = test::contentsOf(file);
  EXPECT_EQ(bytes.substr(4, 4), "ftyp");
  EXPECT_THAT(bytes, HasSubstr("moov"));
}

TEST(Mp4Writer, LeavesNothingAndTheOldFileIfItIsNotFinished) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "a.mp4") << "old";
  {
    Mp4Writer writer(folder / "a.mp4");
    writer.add(cv::Mat(64, 96, CV_8UC3, cv::Scalar::all(0)), 0);
  }
  EXPECT_EQ(fileCount(folder.path()), 1u);
  EXPECT_EQ(std::filesystem::file_size(folder / "a.mp4"), 3u);
}

TEST(Mp4Writer, RefusesNoPictureAndAMissingFolder) {
  const test::TemporaryFolder folder;
  EXPECT_THAT(test::messageOf([&] { Mp4Writer(folder / "a.mp4").finish(); }), HasSubstr("no picture"));
  EXPECT_THAT(test::messageOf([&] { Mp4Writer(folder / "x/a.mp4"); }), HasSubstr("cannot be written"));
  EXPECT_EQ(fileCount(folder.path()), 0u);
}

TEST(Interruption, TurnsASignalIntoAnErrorAfterWhichNothingIsLeft) {
  const test::TemporaryFolder folder;
  const auto write = [&] {
    const Interruption interruption;
    Mp4Writer writer(folder / "a.mp4");
    interruption.check();
    ASSERT_EQ(std::raise(SIGINT), 0);
    interruption.check();
  };
  try {
    write();
    ADD_FAILURE() << "the signal was ignored";
  } catch (const ExitCode& end) {
    EXPECT_EQ(end.code(), 128 + SIGINT);
  }
  EXPECT_EQ(fileCount(folder.path()), 0u);
}

pipeline::PairResult resultOf(int index, bool is_valid) {
  pipeline::PairResult result;
  result.sequence = static_cast<std::uint64_t>(index);
  result.left.exposure_ns = index * kPeriod_ns;
  result.right.exposure_ns = result.left.exposure_ns + 2'000'000;
  result.estimate.valid = is_valid;
  if (!is_valid) result.estimate.reasons = vo::OdometryReason::too_few_matches;
  result.motion.T_world_body.translation() = Eigen::Vector3d(0.5 * index, 0.0, 0.0);
  result.motion.velocity = Eigen::Vector3d(2.0, 0.0, 0.0);
  result.worst.emplace();
  return result;
}

TEST(ReplayPictures, AreOfOneEvenSizeAndShowPoints) {
  ReplayPictures pictures, without_points;
  const cv::Mat left(201, 321, CV_8UC1, cv::Scalar::all(90));
  constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  vo::LandmarkViews points(2);
  points[0] = {
      .left_x = 100.0F, .left_y = 150.0F, .previous_x = 95.0F, .previous_y = 150.0F, .inverse_depth = 0.2F};
  points[1] = {.left_x = 50.0F,
               .left_y = 150.0F,
               .previous_x = kUnknown,
               .previous_y = kUnknown,
               .inverse_depth = kUnknown};
  for (int i = 0; i < 3; ++i) {
    const cv::Mat shown = pictures.draw(resultOf(i, i > 0), left, points);
    EXPECT_EQ(shown.type(), CV_8UC3);
    EXPECT_EQ(shown.cols % 2 + shown.rows % 2, 0);
    EXPECT_GE(shown.cols, 960);
    const cv::Mat plain = without_points.draw(resultOf(i, i > 0), left, {});
    const cv::Mat difference = cv::abs(shown - plain);
    EXPECT_GT(cv::sum(difference)[0], 0.0);
  }
}

}  // namespace
}  // namespace cartvo
