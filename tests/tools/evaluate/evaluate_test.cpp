// Evaluation of trajectories: association, error measures, alignment, report, plot.

#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "common/units.hpp"
#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"
#include "support/tools/paths.hpp"
#include "support/tools/run_cartvo.hpp"
#include "tools/evaluate/alignment.hpp"
#include "tools/evaluate/association.hpp"
#include "tools/evaluate/axes_alignment.hpp"
#include "tools/evaluate/evaluation.hpp"
#include "tools/evaluate/figures.hpp"
#include "tools/evaluate/report.hpp"

namespace cartvo {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

using test::circle;
using test::kPeriod;
using test::poseAt;
using test::scaled;
using test::straight;

TEST(Evaluation, PerfectEstimateHasNoError) {
  const Trajectory truth = circle(1200, 30.0, 1.0);
  const Evaluation evaluation = evaluate(associateByRows(truth, truth));
  EXPECT_NEAR(evaluation.final_drift, 0.0, 1e-9);
  EXPECT_NEAR(evaluation.absolute_aligned, 0.0, 1e-9);
  EXPECT_NEAR(evaluation.relative_translation, 0.0, 1e-9);
  EXPECT_NEAR(evaluation.short_segments.all.translation, 0.0, 1e-9);
  EXPECT_NEAR(evaluation.long_segments.all.rotation, 0.0, 1e-9);
  EXPECT_EQ(evaluation.short_segments.each.size(), 4u);
  EXPECT_EQ(evaluation.long_segments.each.size(), 8u);
}

TEST(Evaluation, ScaleErrorOfTwoPercentGivesTwoPercentOfEachSegment) {
  // Steps of 0.4999 m: a segment ends at the first pose beyond its length, up to a step later, as in the
  // devkit.
  const Trajectory truth = straight(2001, 0.4999);
  const Evaluation evaluation = evaluate(associateByRows(scaled(truth, 1.02), truth));
  EXPECT_NEAR(*evaluation.final_drift_fraction, 0.02, 1e-9);
  EXPECT_NEAR(evaluation.relative_translation, 0.02 * 0.4999, 1e-9);
  EXPECT_NEAR(evaluation.relative_rotation, 0.0, 1e-9);
  for (const SegmentGroup& group : {evaluation.short_segments, evaluation.long_segments}) {
    for (const SegmentErrors& errors : group.each) {
      const double reached = std::ceil(errors.length / 0.4999) * 0.4999;
      EXPECT_NEAR(errors.translation, 0.02 * reached / errors.length, 1e-6) << errors.length;
      EXPECT_NEAR(errors.rotation, 0.0, 1e-9);
    }
  }
  EXPECT_NEAR(evaluation.long_segments.all.translation, 0.02, 2e-4);
}

TEST(Evaluation, ConstantYawDriftGivesItsAnglePerMetre) {
  // The estimate turns by 0.01 deg/m although the path is straight.
  const double step = 0.4999, drift = 0.01 * kRadiansPerDegree;
  Trajectory estimate;
  const Trajectory truth = straight(2001, step);
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() = Eigen::AngleAxisd(drift * step, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  motion.translation().x() = step;
  estimate.push_back(truth.front());
  for (std::size_t i = 1; i < truth.size(); ++i) {
    estimate.push_back({truth[i].time_ns, estimate.back().pose * motion});
  }
  const Evaluation evaluation = evaluate(associateByRows(estimate, truth));
  EXPECT_NEAR(evaluation.relative_rotation, drift * step, 1e-12);
  EXPECT_NEAR(evaluation.final_rotation, drift * step * 2000, 1e-9);
  for (const SegmentErrors& errors : evaluation.long_segments.each) {
    EXPECT_NEAR(errors.rotation, drift, 0.006 * drift) << errors.length;  // up to a step beyond the length
    // An arc of angle a against its tangent: the chord's end lies about a/2 of the length beside it.
    EXPECT_NEAR(errors.translation, drift * errors.length / 2.0, 0.02 * drift * errors.length)
        << errors.length;
  }
}

TEST(Evaluation, StartsShortSegmentsAtEachPoseAndLongOnesAtEachTenthPose) {
  const Trajectory truth = straight(301, 1.0001);
  const Evaluation evaluation = evaluate(associateByRows(truth, truth));
  // The length of 40 m is first exceeded 40 poses on; that of 100 m, 100 poses on.
  EXPECT_EQ(evaluation.short_segments.each.at(3).count, 261);
  EXPECT_EQ(evaluation.long_segments.each.at(0).count, 21);
  EXPECT_EQ(evaluation.long_segments.each.size(), 3u);
}

TEST(Evaluation, AlignsRigidlyWithoutScale) {
  const Trajectory truth = circle(200, 10.0, 0.4);
  Trajectory moved = truth;
  Eigen::Isometry3d move(Eigen::AngleAxisd(1.0, Eigen::Vector3d(1, 1, 0).normalized()));
  move.translation() = Eigen::Vector3d(5, -3, 2);
  for (StampedPose& stamped : moved)
    stamped.pose = move * stamped.pose;
  EXPECT_NEAR(evaluate(associateByRows(moved, truth)).absolute_aligned, 0.0, 1e-9);
  EXPECT_NEAR(evaluate(associateByRows(moved, truth)).absolute_origin, 0.0, 1e-9);

  // A straight line that is 2 % too long, aligned at the middle: the RMS of the residuals is 0.02 L /
  // sqrt(12).
  const Trajectory line = straight(2001, 0.05);
  const Evaluation evaluation = evaluate(associateByRows(scaled(line, 1.02), line));
  EXPECT_NEAR(evaluation.absolute_aligned, 0.02 * 100.0 / std::sqrt(12.0), 1e-3);
  EXPECT_NEAR(evaluation.absolute_origin, 0.02 * 100.0 / std::sqrt(3.0), 1e-3);
}

TEST(Evaluation, StandstillHasNoDriftPercentage) {
  const Trajectory truth = straight(10, 0.0);
  const Evaluation evaluation = evaluate(associateByRows(straight(10, 0.001), truth));
  EXPECT_FALSE(evaluation.final_drift_fraction);
  EXPECT_NEAR(evaluation.final_drift, 0.009, 1e-12);
  EXPECT_TRUE(evaluationJson(evaluation)["final_drift_percent"].is_null());
  EXPECT_THAT(evaluationTable(evaluation), HasSubstr("the path is too short"));
}

TEST(AxesAlignment, FindsRotationOfTruthAxes) {
  const Trajectory truth = circle(400, 30.0, 0.5);
  const Eigen::Vector3d turned(0.004, -0.003, 0.005);
  const Evaluation evaluation = evaluate(associateByRows(rotateAxes(truth, -turned), truth));
  EXPECT_NEAR(evaluation.short_segments.all.translation, std::hypot(0.003, 0.005), 0.0015);
  ASSERT_TRUE(evaluation.aligned_axes);
  EXPECT_LT((evaluation.aligned_axes->rotation - turned).norm(), 1e-9);
  EXPECT_NEAR(evaluation.aligned_axes->short_segments.all.translation, 0.0, 1e-9);
  EXPECT_NEAR(evaluation.aligned_axes->short_segments.all.rotation, 0.0, 1e-9);
}

TEST(AxesAlignment, LeavesUnobservableRotationAboutStraightPathAtZero) {
  const Trajectory truth = straight(200, 0.5);
  const Trajectory estimate = rotateAxes(truth, {0.05, -0.003, 0.005});
  const Eigen::Vector3d found = axesRotation(associateByRows(estimate, truth)).value();
  EXPECT_NEAR(found.x(), 0.0, 1e-4);
  EXPECT_NEAR(found.y(), 0.003, 2e-4);
  EXPECT_NEAR(found.z(), -0.005, 2e-4);
}

TEST(AxesAlignment, DoesNotChangeScaleError) {
  const Trajectory truth = circle(400, 30.0, 0.5);
  const Trajectory longer = scaled(truth, 1.02);
  const AlignedAxes aligned = evaluate(associateByRows(longer, truth)).aligned_axes.value();
  EXPECT_NEAR(aligned.rotation.norm(), 0.0, 1e-9);
  EXPECT_NEAR(aligned.short_segments.all.translation, 0.02, 0.002);
}

TEST(AxesAlignment, IsZeroAtStandstillAndEmptyForShortPath) {
  const Trajectory truth = straight(200, 0.5);
  EXPECT_EQ(axesRotation(associateByRows(straight(200, 0.0), truth)).value(), Eigen::Vector3d::Zero());
  const Evaluation evaluation = evaluate(associateByRows(straight(5, 0.1), straight(5, 0.1)));
  EXPECT_FALSE(evaluation.aligned_axes);
  EXPECT_TRUE(evaluationJson(evaluation)["axes_aligned"].is_null());
}

TEST(Association, ByTimeInterpolatesTruth) {
  const Trajectory truth = circle(100, 10.0, 0.05);
  Trajectory estimate;
  for (std::size_t i = 0; i + 1 < truth.size(); ++i) {
    // A third of the way on: angle and position of the circle at that instant.
    const double angle = (static_cast<double>(i) + 1.0 / 3.0) * 0.05 / 10.0;
    StampedPose stamped = poseAt(0, {10.0 * std::sin(angle), 10.0 * (1.0 - std::cos(angle)), 0.0}, angle);
    stamped.time_ns = truth[i].time_ns + kPeriod / 3;
    estimate.push_back(stamped);
  }
  const AssociatedTrajectories associated = associateByTime(estimate, truth);
  ASSERT_EQ(associated.truth.size(), estimate.size());
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    EXPECT_TRUE(associated.truth[i].pose.isApprox(estimate[i].pose, 1e-4));
  }
}

TEST(Association, ByTimeOmitsPosesWithoutTruth) {
  Trajectory truth = straight(50, 1.0);
  truth.erase(truth.begin() + 20, truth.begin() + 30);  // a second without truth
  const AssociatedTrajectories associated = associateByTime(straight(60, 1.0), truth);
  EXPECT_EQ(associated.estimate.size(), 40u);
  EXPECT_EQ(associated.unmatched, 20u);
}

TEST(Association, ByTimeToleratesRoundedTimesAtEndsOfTruth) {
  const Trajectory truth = straight(50, 1.0);
  Trajectory estimate = truth;
  estimate.front().time_ns -= 16'000;
  estimate.back().time_ns += 16'000;
  EXPECT_EQ(associateByTime(estimate, truth).unmatched, 0u);
  estimate.back().time_ns += 2'000'000;
  EXPECT_EQ(associateByTime(estimate, truth).unmatched, 1u);
}

TEST(Association, ByTimeRejectsDifferentClocksAndDrives) {
  Trajectory truth = straight(50, 1.0);
  for (StampedPose& stamped : truth)
    stamped.time_ns += 1'000'000'000'000;
  EXPECT_THAT(test::messageOf([&] { associateByTime(straight(50, 1.0), truth); }),
              AllOf(HasSubstr("the estimate is of 0.000 s to 4.900 s, the truth of 1000.000 s to 1004.900 s"),
                    HasSubstr("'cartvo simulate' keeps the truth of an earlier run as")));
}

TEST(Association, ByTimeRejectsMillisecondsReadAsSeconds) {
  Trajectory truth = straight(50, 1.0);
  for (StampedPose& stamped : truth)
    stamped.time_ns *= 1000;
  EXPECT_THAT(test::messageOf([&] { associateByTime(straight(50, 1.0), truth); }),
              HasSubstr("the estimate is of 0.000 s to 4.900 s, the truth of 0.000 s to 4900.000 s"));
}

TEST(Association, ByRowsRequiresEqualNumberOfRows) {
  EXPECT_THAT(test::messageOf([] { associateByRows(straight(50, 1.0), straight(51, 1.0)); }),
              HasSubstr("the estimate has 50 poses, the truth 51"));
  EXPECT_THAT(test::messageOf([] { associateByRows(straight(1, 1.0), straight(1, 1.0)); }),
              HasSubstr("at least two are needed"));
}

TEST(Association, OfFilesIsByTimeForTumAndByRowsForKitti) {
  const test::TemporaryFolder folder;
  writeTum(folder / "truth.tum", straight(50, 1.0));
  writeTum(folder / "estimate.tum", straight(40, 1.0));
  writeKitti(folder / "estimate.txt", straight(40, 1.0));
  writeKitti(folder / "truth.txt", straight(40, 1.0));
  EXPECT_EQ(associateFiles(folder / "estimate.tum", folder / "truth.tum", {}).method,
            AssociationMethod::time);
  EXPECT_EQ(associateFiles(folder / "estimate.txt", folder / "truth.txt", {}).method,
            AssociationMethod::rows);
  EXPECT_EQ(associateFiles(folder / "estimate.tum", folder / "truth.txt", {}).method,
            AssociationMethod::rows);
  EXPECT_THAT(test::messageOf([&] { associateFiles(folder / "estimate.txt", folder / "truth.tum", {}); }),
              HasSubstr((folder / "truth.tum").string()));
}

TEST(Report, HasSameNumbersInTableAndJson) {
  const Trajectory truth = straight(301, 1.0001);
  const Evaluation evaluation = evaluate(associateByRows(scaled(truth, 1.02), truth));
  const nlohmann::ordered_json json = evaluationJson(evaluation);
  EXPECT_NEAR(json["final_drift_percent"].get<double>(), 2.0, 1e-9);
  EXPECT_EQ(json["poses"], 301);
  EXPECT_EQ(json["segments_5_to_40_m"]["by_length"].size(), 4u);
  EXPECT_NEAR(json["segments_100_to_800_m"]["translation_percent"].get<double>(), 2.0, 1e-3);
  const std::string table = evaluationTable(evaluation);
  EXPECT_THAT(table, HasSubstr("final drift of the path            2.000 %"));
  EXPECT_THAT(table, HasSubstr("300.030 m (estimated: 306.031 m)"));
  EXPECT_THAT(table, HasSubstr("(turned by 0.000, 0.000, 0.000 deg)"));
  EXPECT_EQ(json["axes_aligned"]["rotation_deg"], (nlohmann::ordered_json{0.0, 0.0, 0.0}));
  EXPECT_EQ(json["axes_aligned"]["segments_5_to_40_m"]["translation_percent"],
            json["segments_5_to_40_m"]["translation_percent"]);
}

TEST(EvaluateCommand, PrintsJson) {
  const test::TemporaryFolder folder;
  const std::string truth = folder / "truth.tum", estimate = folder / "estimate.tum";
  writeTum(truth, straight(150, 1.0), TrajectoryFrame::body);
  writeTum(estimate, scaled(straight(150, 1.0), 1.02), TrajectoryFrame::body);
  const auto json =
      nlohmann::json::parse(test::pipeCartvo("evaluate --json " + estimate + " " + truth).output);
  EXPECT_EQ(json["estimate"], estimate);
  EXPECT_EQ(json["truth"], truth);
  EXPECT_EQ(json["poses"], 150);
}

TEST(EvaluationReport, AsksAboutTheFrameIfTheAxesDiffer) {
  const Trajectory body = circle(300, 20.0, 0.5);
  Eigen::Isometry3d T_body_camera = Eigen::Isometry3d::Identity();
  T_body_camera.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  Trajectory camera = body;
  for (StampedPose& stamped : camera)
    stamped.pose = T_body_camera.inverse() * stamped.pose * T_body_camera;
  const Evaluation wrong = evaluate(associateByRows(camera, body));
  EXPECT_THAT(evaluationTable(wrong), HasSubstr("problem: the axes of the two files differ by 1"));
  EXPECT_THAT(evaluationJson(wrong)["problem"].get<std::string>(), HasSubstr("is one of the left camera"));
  const Evaluation right = evaluate(associateByRows(scaled(body, 1.1), body));
  EXPECT_THAT(evaluationTable(right), ::testing::Not(HasSubstr("problem")));
  EXPECT_EQ(evaluationJson(right)["problem"], "");
}

TEST(Association, RefusesFilesThatStateDifferentFrames) {
  const test::TemporaryFolder folder;
  writeTum(folder / "trajectory.tum", straight(50, 1.0), TrajectoryFrame::body);
  writeKitti(folder / "poses.txt", straight(50, 1.0));
  writeTum(folder / "camera.tum", straight(50, 1.0), TrajectoryFrame::left_camera);
  EXPECT_THAT(
      test::messageOf([&] { associateFiles(folder / "trajectory.tum", folder / "poses.txt", {}); }),
      ::testing::AllOf(HasSubstr("trajectory.tum has poses of the cart's body"),
                       HasSubstr("poses.txt of the left camera"), HasSubstr("files of the same frame")));
  EXPECT_EQ(associateFiles(folder / "camera.tum", folder / "poses.txt", {}).method, AssociationMethod::rows);
}

ReportInput inputOf(const AssociatedTrajectories& associated) {
  ReportInput input;
  input.associated = associated;
  input.evaluation = evaluate(associated);
  input.view = TopView::body_axes;
  return input;
}

TEST(Plot, ShowsAllPathsInTheirColours) {
  const Trajectory truth = circle(300, 20.0, 0.5);
  const ReportInput one = inputOf(associateByRows(scaled(truth, 1.1), truth)),
                    other = inputOf(associateByRows(scaled(truth, 0.9), truth));
  const cv::Mat plot = evaluationPlot({one, other}).picture();
  const auto pixels_near = [&](const cv::Scalar& colour) {
    cv::Mat mask;
    cv::inRange(plot, colour - cv::Scalar::all(12), colour + cv::Scalar::all(12), mask);
    return cv::countNonZero(mask);
  };
  EXPECT_EQ(plot.type(), CV_8UC3);
  EXPECT_GT(pixels_near({178, 114, 0}), 300);  // an estimate
  EXPECT_GT(pixels_near({0, 159, 230}), 300);  // the other
  EXPECT_GT(pixels_near({34, 34, 34}), 300);   // the truth
}

TEST(Plot, DrawsStandstill) {
  EXPECT_NO_THROW(evaluationPlot({inputOf(associateByRows(straight(5, 0.0), straight(5, 0.0)))}));
}

}  // namespace
}  // namespace cartvo
