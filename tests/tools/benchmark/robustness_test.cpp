// Tests of the robustness benchmark: disturbances, errors per second, comparison and report.
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "support/lab/tiny_world.hpp"
#include "support/temporary_folder.hpp"
#include "support/tools/silent.hpp"
#include "tools/benchmark/robustness/robustness_benchmark.hpp"
#include "tools/benchmark/robustness/robustness_report.hpp"

namespace cartvo::benchmark {
namespace {

using ::testing::HasSubstr;

/// A rendered sequence of seven pairs, rendered once.
class Disturbances : public testing::Test {
 protected:
  static const Sequence& sequence() {
    static const test::TemporaryFolder folder;
    static const Sequence rendered =
        renderedSequence(test::tinyWorld(), WorldCache(folder.path()), [](int, int) {});
    return rendered;
  }

  struct Played {
    std::vector<cv::Mat> left, right;
    std::vector<std::int64_t> instants_ns;
  };
  static Played played(const std::string& disturbance) {
    DisturbedSequence opened = disturbed(sequence(), disturbanceNamed(disturbance));
    Played all;
    capture::Frame frame;
    while (opened.source.left->read(frame, {}) == capture::ReadOutcome::frame) {
      all.left.push_back(frame.image.clone());
      all.instants_ns.push_back(frame.exposure_ns);
    }
    while (opened.source.right->read(frame, {}) == capture::ReadOutcome::frame)
      all.right.push_back(frame.image.clone());
    return all;
  }
  /// Share of the pixels that differ, in a part of the image.
  static double changed(const cv::Mat& a, const cv::Mat& b, const cv::Rect& part) {
    return static_cast<double>(cv::countNonZero(a(part) != b(part))) / part.area();
  }
};

TEST_F(Disturbances, HaveDistinctNames) {
  std::set<std::string> names;
  for (const Disturbance& disturbance : allDisturbances()) {
    EXPECT_TRUE(names.insert(disturbance.name).second) << disturbance.name;
    EXPECT_EQ(disturbanceNamed(disturbance.name).explanation, disturbance.explanation);
  }
  EXPECT_THROW(disturbanceNamed("rain"), std::invalid_argument);
}

TEST_F(Disturbances, LeaveOutPairsWithTheirTruth) {
  const std::size_t all = sequence().truth.left_camera.size();
  for (const auto& [name, count] : {std::pair("every2", (all + 1) / 2), std::pair("every3", (all + 2) / 3)}) {
    const DisturbedSequence opened = disturbed(sequence(), disturbanceNamed(name));
    const Played pairs = played(name);
    EXPECT_EQ(pairs.left.size(), count) << name;
    EXPECT_EQ(pairs.right.size(), count) << name;
    ASSERT_EQ(opened.truth.left_camera.size(), count) << name;
    for (std::size_t i = 0; i < count; ++i)
      EXPECT_EQ(opened.truth.left_camera[i].time_ns, pairs.instants_ns[i]) << name;
  }
  EXPECT_EQ(played("lose30").instants_ns, played("lose30").instants_ns) << "the same pairs each time";
}

TEST_F(Disturbances, ChangeOnlyTheirPartOfThePictures) {
  const Played intact = played("none");
  const cv::Size size = intact.left.front().size();
  const cv::Rect top(0, 0, size.width, size.height / 6),
      bottom(0, size.height * 7 / 8, size.width, size.height / 8);
  const cv::Rect middle(0, size.height / 3, size.width, size.height / 3);
  const Played text = played("text"), strip = played("strip");
  EXPECT_GT(changed(intact.left[0], text.left[0], top), 0.03);
  EXPECT_EQ(changed(intact.left[0], text.left[0], middle), 0.0);
  EXPECT_GT(changed(intact.right[2], strip.right[2], bottom), 0.9);
  EXPECT_EQ(changed(intact.right[2], strip.right[2], middle), 0.0);
  EXPECT_EQ(changed(strip.left[0], strip.left[3], bottom), 0.0) << "the cart does not move in its picture";
  cv::Scalar mean, before, after;
  cv::meanStdDev(intact.left[0], mean, before);
  cv::meanStdDev(played("contrast").left[0], mean, after);
  EXPECT_NEAR(after[0], before[0] / 3.0, 0.5);
}

TEST_F(Disturbances, JumpsTurnPicturesAndTruth) {
  const Played intact = played("none");
  for (const char* name : {"pitch-jumps", "yaw-jumps"}) {
    const DisturbedSequence opened = disturbed(sequence(), disturbanceNamed(name));
    const Played turned = played(name);
    const cv::Size size = opened.rig.rig.left.size;
    EXPECT_EQ(turned.left.front().size(), size) << name;
    EXPECT_LT(size.width, intact.left.front().cols) << name;
    ASSERT_EQ(opened.truth.left_camera.size(), sequence().truth.left_camera.size());
    EXPECT_TRUE(opened.truth.left_camera.front().pose.isApprox(Eigen::Isometry3d::Identity()));
  }
}

TEST_F(Disturbances, OfTheRigExchangePictures) {
  const Played intact = played("none");
  const auto equal = [](const cv::Mat& a, const cv::Mat& b) { return cv::countNonZero(a != b) == 0; };
  EXPECT_TRUE(equal(played("swapped").left[1], intact.right[1]));
  EXPECT_TRUE(equal(played("swapped").right[1], intact.left[1]));
  EXPECT_TRUE(equal(played("twice").right[1], intact.left[1]));
  EXPECT_TRUE(equal(played("wrong-stamps").right[1], intact.right[2]));
  const DisturbedSequence wrong = disturbed(sequence(), disturbanceNamed("wrong-rig"));
  const DisturbedSequence right = disturbed(sequence(), disturbanceNamed("none"));
  EXPECT_FALSE(wrong.rig.rig.T_right_left.isApprox(right.rig.rig.T_right_left));
}

/// A replay and its truth along a line at 1 m/s, ten pairs a second; the estimate is `scale` times as long.
std::vector<double> errorsAlongALine(double scale) {
  Replay replay;
  SequenceTruth truth;
  for (int i = 0; i <= 30; ++i) {
    const std::int64_t time_ns = i * 100'000'000LL;
    ReplayedPair& pair = replay.pairs.emplace_back();
    pair.exposure_ns = time_ns;
    pair.T_first_left.translation().z() = scale * 0.1 * i;
    truth.left_camera.push_back({time_ns, Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, 0.1 * i))});
  }
  return errorsPerSecond(replay, truth);
}

TEST(ErrorsPerSecond, AreThoseOfEachWholeSecond) {
  for (const double scale : {1.0, 1.1, 0.0}) {
    const std::vector<double> errors = errorsAlongALine(scale);
    ASSERT_EQ(errors.size(), 3u);
    for (const double error : errors)
      EXPECT_NEAR(error, std::abs(scale - 1.0), 1e-9);
  }
}

/// A row whose estimators have these errors and counts.
RobustnessRow rowWith(const std::vector<double>& errors, const std::vector<double>& of_thesis) {
  RobustnessRow row{"campus 7", disturbanceNamed("lose30"), {}, {}, 0.001};
  row.reprojection.errors_per_second = errors;
  row.thesis.errors_per_second = of_thesis;
  for (DisturbedAccuracy* one : {&row.reprojection, &row.thesis})
    one->accuracy.pairs = 101;
  return row;
}

TEST(RobustnessRow, IsWorseByMoreThanChance) {
  EXPECT_FALSE(rowWith({0.01, 0.02, 0.01, 0.03}, {0.012, 0.018, 0.011, 0.028}).isWorse());
  EXPECT_TRUE(rowWith({0.04, 0.05, 0.04, 0.06}, {0.012, 0.018, 0.011, 0.028}).isWorse());
  EXPECT_FALSE(rowWith({0.012, 0.018, 0.011, 0.028}, {0.04, 0.05, 0.04, 0.06}).isWorse());
  RobustnessRow lost = rowWith({}, {});
  lost.reprojection.accuracy.invalid = 30;
  EXPECT_TRUE(lost.isWorse());
  lost.thesis.accuracy.validity.above_limit = 1;
  EXPECT_FALSE(lost.isWorse()) << "a VALID message above a limit is worse than none";
  lost.reprojection.accuracy.validity.above_limit = 2;
  EXPECT_TRUE(lost.isWorse());
}

TEST(RobustnessBenchmark, MeasuresEachDisturbanceOfAWorld) {
  const test::TemporaryFolder folder;
  RobustnessSettings settings;
  settings.worlds = {test::tinyWorld()};
  settings.disturbances = {"every2", "half-period"};
  settings.odometry.features = 200;
  settings.cache = folder.path();
  const auto rows = runRobustnessBenchmark(settings, test::silent());
  ASSERT_EQ(rows.size(), 3u);
  const std::string table = robustnessTable(rows, ReportFormat::text);
  for (const char* text : {"none", "every2", "half-period", "The default is worse than the thesis in"})
    EXPECT_THAT(table, HasSubstr(text));
  const auto json = robustnessJson(rows);
  EXPECT_EQ(json["rows"].size(), 3u);
  EXPECT_EQ(json["rows"][1]["disturbance"], "every2");
  EXPECT_GT(json["rows"][0]["reprojection"]["pairs"], json["rows"][1]["reprojection"]["pairs"]);
}

}  // namespace
}  // namespace cartvo::benchmark
