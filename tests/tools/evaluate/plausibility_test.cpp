// Problems that an evaluation names, and their remedies: clocks, conventions, axes, several estimates.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/units.hpp"
#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"
#include "support/tools/paths.hpp"
#include "support/tools/run_cartvo.hpp"
#include "tools/evaluate/alignment.hpp"
#include "tools/evaluate/association.hpp"
#include "tools/evaluate/axes_alignment.hpp"
#include "tools/evaluate/evaluation.hpp"
#include "tools/evaluate/report.hpp"

namespace cartvo {
namespace {

using test::circle;
using test::delayed;
using test::scaled;
using test::straight;
using test::winding;
using ::testing::AllOf;
using ::testing::HasSubstr;

std::string problemsOf(const AssociatedTrajectories& associated) {
  std::string text;
  for (const std::string& problem : evaluate(associated).problems)
    text += problem + "\n";
  return text;
}

TEST(ClockProblem, NamesTheOffsetOfOverlappingFiles) {
  const Trajectory estimate = winding(600, 0.0);
  EXPECT_THAT(problemsOf(associateByTime(estimate, delayed(estimate, 18.0))),
              AllOf(HasSubstr("GPS time is ahead of UTC"), HasSubstr("--offset 18.00")));
  EXPECT_THAT(problemsOf(associateByTime(estimate, delayed(estimate, -1.5))), HasSubstr("--offset -1.50"));
  EXPECT_EQ(problemsOf(associateByTime(estimate, estimate)), "");
  EXPECT_THAT(problemsOf(associateByTime(rotateAxes(estimate, {3.14159, 0.0, 0.0}), estimate)),
              AllOf(HasSubstr("the axes of the two files"), ::testing::Not(HasSubstr("clocks"))));
  EXPECT_EQ(problemsOf(associateByTime(scaled(estimate, 1.1), estimate)), "");
}

TEST(ClockProblem, NamesTheOffsetOfFilesWithoutACommonTime) {
  const Trajectory truth = winding(1000, 0.0);
  const Trajectory estimate(truth.begin() + 300, truth.begin() + 700);
  const auto refusal = [&](double delay) {
    return test::messageOf([&] { associateByTime(delayed(estimate, -delay), truth); });
  };
  EXPECT_THAT(refusal(-315'964'782.0),
              AllOf(HasSubstr("counts from 1980"), HasSubstr("--offset -315964782.00")));
  EXPECT_THAT(refusal(7200.0), AllOf(HasSubstr("time zone"), HasSubstr("--offset 7200.00")));
  EXPECT_THAT(refusal(1'700'000'000.0),
              AllOf(HasSubstr("the two clocks differ"), HasSubstr("--offset 1700000000.00")));
}

TEST(ClockProblem, IsNotNamedIfTheMotionCannotTell) {
  EXPECT_EQ(problemsOf(associateByTime(straight(200, 1.0), delayed(straight(200, 1.0), 5.0))), "");
  EXPECT_EQ(problemsOf(associateByTime(circle(200, 30.0, 0.5), delayed(circle(200, 30.0, 0.5), 5.0))), "");
}

TEST(ConventionProblem, NamesTheOrderOfQuaternionsAndTheDirectionOfPoses) {
  const Trajectory truth = winding(600, 0.0);
  Trajectory w_first = truth, inverse = truth, inverse_rotations = truth;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Eigen::Quaterniond q(truth[i].pose.linear());
    w_first[i].pose.linear() = Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()).toRotationMatrix();
    inverse[i].pose = truth[i].pose.inverse();
    inverse_rotations[i].pose.linear() = truth[i].pose.linear().transpose();
  }
  EXPECT_THAT(problemsOf(associateByRows(truth, w_first)),
              HasSubstr("the truth is read in another convention: its quaternions"));
  EXPECT_THAT(problemsOf(associateByRows(w_first, truth)),
              HasSubstr("the estimate is read in another convention"));
  EXPECT_THAT(problemsOf(associateByRows(inverse, truth)),
              HasSubstr("poses of one of the two files seem to be inverse"));
  EXPECT_THAT(problemsOf(associateByRows(inverse_rotations, truth)),
              HasSubstr("rotations of one of the two files seem to be inverse"));
}

TEST(ConventionProblem, NamesTurnedAxesFromTwoDegreesOn) {
  const Trajectory truth = winding(600, 0.0);
  const auto turned = [&](const Eigen::Vector3d& rotation_deg) {
    return problemsOf(associateByRows(rotateAxes(truth, kRadiansPerDegree * rotation_deg), truth));
  };
  EXPECT_EQ(turned({0.0, 1.5, 0.0}), "");
  EXPECT_THAT(turned({0.0, 6.2, 0.0}),
              AllOf(HasSubstr("differ by 6.2 deg"), HasSubstr("--align"), HasSubstr("T_body_camera")));
  EXPECT_THAT(turned({180.0, 0.0, 0.0}), HasSubstr("forward, right, down"));
}

TEST(Fit, WithoutScaleKeepsIt) {
  AssociatedTrajectories associated = associateByRows(scaled(winding(600, 0.0), 0.8), winding(600, 0.0));
  fitEstimate({.aligns = true}, associated);
  EXPECT_EQ(associated.scale, 1.0);
}

TEST(Fit, OfWorldAxesAndScaleRemovesThem) {
  const Trajectory truth = winding(600, 0.0);
  Trajectory moved = scaled(rotateAxes(truth, {0.1, -0.2, 0.3}), 0.8);
  const Eigen::Isometry3d move =
      Eigen::Translation3d(5, -3, 2) * Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitZ());
  for (StampedPose& stamped : moved)
    stamped.pose = move * stamped.pose;
  AssociatedTrajectories associated = associateByRows(moved, truth);
  fitEstimate({.aligns = true, .corrects_scale = true}, associated);
  EXPECT_NEAR(associated.scale, 1.25, 1e-6);
  const Evaluation evaluation = evaluate(associated);
  EXPECT_NEAR(evaluation.absolute_origin, 0.0, 1e-6);
  EXPECT_NEAR(evaluation.final_drift, 0.0, 1e-6);
  EXPECT_TRUE(evaluation.problems.empty());
  AssociatedTrajectories standing = associateByRows(straight(10, 0.0), straight(10, 0.0));
  EXPECT_THAT(test::messageOf([&] { fitEstimate({.aligns = true}, standing); }), HasSubstr("standstill"));
}

TEST(EvaluateCommand, ComparesSeveralEstimates) {
  const test::TemporaryFolder folder;
  const std::string one = folder / "one.tum", other = folder / "other.tum", truth = folder / "truth.tum";
  writeTum(one, scaled(winding(600, 0.0), 1.02));
  writeTum(other, delayed(winding(600, 0.0), -18.0));
  writeTum(truth, winding(600, 0.0));
  const std::string files = one + " " + other + " --truth " + truth;
  const std::string table = test::pipeCartvo("evaluate " + files).output;
  EXPECT_THAT(table,
              AllOf(HasSubstr("drift (%)"), HasSubstr("problem: " + other), HasSubstr("--offset 18.00")));
  const auto json = nlohmann::json::parse(test::pipeCartvo("evaluate --json --offset 18 " + files).output);
  ASSERT_EQ(json.size(), 2U);
  EXPECT_NEAR(json[1]["final_drift_m"].get<double>(), 0.0, 1e-6);
  EXPECT_EQ(test::pipeCartvo("evaluate " + one + " " + other + " " + truth).exit_code, 2);
}

TEST(Association, SaysThatTheMountIsUnknown) {
  const test::TemporaryFolder folder;
  writeTum(folder / "trajectory.tum", straight(50, 1.0), TrajectoryFrame::unmounted_camera);
  writeTum(folder / "truth.tum", straight(50, 1.0), TrajectoryFrame::body);
  EXPECT_THAT(problemsOf(associateFiles(folder / "trajectory.tum", folder / "truth.tum", {})),
              AllOf(HasSubstr("the left camera, mount unknown"), HasSubstr("calibrate mount")));
  EXPECT_EQ(problemsOf(associateFiles(folder / "trajectory.tum", folder / "truth.tum", {.aligns = true})),
            "");
}

}  // namespace
}  // namespace cartvo
