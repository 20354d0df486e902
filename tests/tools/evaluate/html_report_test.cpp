// The report of an evaluation: messages, their consistency, figures and the page.
#include "tools/evaluate/html_report.hpp"

#include <cmath>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"
#include "tools/evaluate/compared_messages.hpp"
#include "tools/evaluate/odometry_file.hpp"

namespace cartvo {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::int64_t kPeriod_ns = 50'000'000;
constexpr double kSpeed = 2.0, kYawRate = 0.1;  // m/s, rad/s

/// Pose of the body on a circle after `seconds`.
Eigen::Isometry3d poseAt(double seconds) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const double yaw = kYawRate * seconds, radius = kSpeed / kYawRate;
  pose.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(radius * std::sin(yaw), radius * (1.0 - std::cos(yaw)), 0.0);
  return pose;
}

Trajectory truthOf(int poses) {
  Trajectory truth;
  for (int i = 0; i < poses; ++i)
    truth.push_back({i * kPeriod_ns, poseAt(1e-9 * static_cast<double>(i * kPeriod_ns))});
  return truth;
}

/// Messages that equal the truth, except the forward velocity by `error`; the first one and `invalid` are not
/// valid.
std::vector<OdometryRow> messagesOf(const Trajectory& truth, double error, std::size_t invalid) {
  std::vector<OdometryRow> rows;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    OdometryRow row;
    row.time_ns = truth[i].time_ns;
    row.valid = i > 0 && i != invalid;
    row.reasons = row.valid ? 0 : 4;
    row.T_world_body = truth[i].pose;
    row.twist << kSpeed + error, 0.0, 0.0, 0.0, 0.0, kYawRate;
    row.twist_covariance = row.pose_covariance = 1e-4 * vo::Matrix6d::Identity();
    const Eigen::Vector3d bound = Eigen::Vector3d::Constant(0.05);
    row.bound = {bound, bound, bound, bound};
    rows.push_back(row);
  }
  return rows;
}

TEST(MotionComparison, OfTrueMotionHasNoErrorAndOfAWrongOneItsSquare) {
  const Trajectory truth = truthOf(40);
  const std::vector<ComparedMessage> exact = compareMotion(messagesOf(truth, 0.0, 20), truth);
  const std::vector<ComparedMessage> wrong = compareMotion(messagesOf(truth, 0.02, 20), truth);
  ASSERT_EQ(exact.size(), truth.size());
  EXPECT_NEAR(exact[10].true_twist[0], kSpeed, 1e-9);
  EXPECT_NEAR(exact[10].true_twist[5], kYawRate, 1e-9);
  EXPECT_NEAR(exact[10].twist_nees.value(), 0.0, 1e-9);
  EXPECT_NEAR(exact[10].pose_nees.value(), 0.0, 1e-9);
  EXPECT_NEAR(wrong[10].twist_nees.value(), 0.02 * 0.02 / 1e-4 / 6.0, 1e-6);
  EXPECT_FALSE(exact[20].twist_nees) << "it is not valid";
  EXPECT_TRUE(std::isnan(exact[20].twist[0]));
  EXPECT_FALSE(exact.back().twist_nees) << "no truth after it";
}

TEST(MotionComparison, LeavesOutStandstillAndUnusableCovariances) {
  const Trajectory truth = truthOf(40);
  std::vector<OdometryRow> rows = messagesOf(truth, 0.0, 0);
  rows[10].twist.setZero();
  rows[11].twist_covariance.setZero();
  const std::vector<ComparedMessage> compared = compareMotion(rows, truth);
  EXPECT_FALSE(compared[10].twist_nees);
  EXPECT_FALSE(compared[11].twist_nees);
  EXPECT_TRUE(compared[12].twist_nees);
}

ReportInput inputOf(const Trajectory& truth) {
  ReportInput input;
  input.associated = associateByTime(truth, truth);
  input.evaluation = evaluate(input.associated);
  input.view = TopView::body_axes;
  input.messages = compareMotion(messagesOf(truth, 0.01, 20), truth);
  return input;
}

std::vector<std::string> namesOf(const std::vector<Figure>& figures) {
  std::vector<std::string> names;
  for (const Figure& figure : figures)
    names.push_back(figure.name);
  return names;
}

TEST(EvaluationFigures, AreOfPathErrorsSegmentsAndMotion) {
  const ReportInput input = inputOf(truthOf(200));
  EXPECT_THAT(namesOf(evaluationFigures({input})),
              testing::ElementsAre("trajectory", "error-over-distance", "error-over-time", "segments",
                                   "velocities", "rates", "nees", "velocity-bounds", "rate-bounds"));
  ReportInput rows = input;
  rows.associated.method = AssociationMethod::rows;
  rows.messages.clear();
  EXPECT_THAT(namesOf(evaluationFigures({rows})),
              testing::ElementsAre("trajectory", "error-over-distance", "segments"));
}

TEST(EvaluationFigures, MarkWhereMessagesAreNotValidExceptTheFirst) {
  const std::vector<ChartSpan> spans = invalidSpans(inputOf(truthOf(40)).messages);
  ASSERT_EQ(spans.size(), 1u);
  EXPECT_DOUBLE_EQ(spans[0].from, 1.0);
  EXPECT_DOUBLE_EQ(spans[0].to, 1.05);
}

TEST(EvaluationFigures, CountTheTimeOfErrorsFromTheFirstMessageAlsoIfTheTruthBeginsLater) {
  ReportInput input = inputOf(truthOf(200));
  Trajectory& estimate = input.associated.estimate;
  estimate.erase(estimate.begin(), estimate.begin() + 100);
  input.associated.truth = estimate;
  const Figure over_time = evaluationFigures({input})[2];
  ASSERT_EQ(over_time.name, "error-over-time");
  EXPECT_DOUBLE_EQ(over_time.chart.panels[0].series[0].points.front().x, 5.0);
}

TEST(EvaluationPage, HasEachFigureWithItsNumbersAndNeedsNoOtherFile) {
  ReportInput input = inputOf(truthOf(200));
  input.estimate = "a<b.tum";
  const std::vector<Figure> figures = evaluationFigures({input});
  const std::string page = evaluationPage({"truth.tum", "2026-01-02", {"rig KITTI"}}, {input}, figures);
  EXPECT_THAT(page, AllOf(HasSubstr("2026-01-02"), HasSubstr("rig KITTI"), HasSubstr("class=\"tiles\""),
                          HasSubstr("The stated deviation of the pose in its epoch is")));
  for (const Figure& figure : figures)
    EXPECT_THAT(page, HasSubstr("<figure id=\"" + figure.name + "\">"));
  EXPECT_THAT(page, AllOf(HasSubstr("a&lt;b.tum"), HasSubstr("2 not valid: 2 too few matches"),
                          HasSubstr("VALID messages above their bound"), HasSubstr("0 of 198"),
                          HasSubstr("prefers-color-scheme:dark"), HasSubstr("Numbers of this figure")));
  EXPECT_THAT(page, AllOf(Not(HasSubstr("src=")), Not(HasSubstr("href=")), Not(HasSubstr("<script")),
                          Not(HasSubstr("nan")), Not(HasSubstr("url("))));
}

TEST(EvaluationFigures, HaveNoPanelWithoutAValue) {
  ReportInput input = inputOf(truthOf(40));
  for (ComparedMessage& message : input.messages)
    message.pose_nees.reset();
  for (const Figure& figure : evaluationFigures({input})) {
    if (figure.name == "nees") {
      EXPECT_EQ(figure.chart.panels.size(), 1U);
      EXPECT_THAT(figure.caption, HasSubstr("Of the pose in its epoch there is no value"));
    }
  }
}

TEST(EvaluationPage, OfSeveralEstimatesHasOneTable) {
  ReportInput one = inputOf(truthOf(200)), other = one;
  one.estimate = "one.tum";
  other.estimate = "other.tum";
  const std::vector<ReportInput> inputs{one, other};
  const std::string page = evaluationPage({"truth.tum", "2026-01-02", {}}, inputs, evaluationFigures(inputs));
  EXPECT_THAT(page, AllOf(HasSubstr("<td>one.tum</td>"), HasSubstr("<td>other.tum</td>"),
                          Not(HasSubstr("<figure id=\"nees\">"))));
}

TEST(EvaluationPage, OfAStandstillHasNoSegments) {
  Trajectory truth = truthOf(5);
  for (StampedPose& stamped : truth)
    stamped.pose.setIdentity();
  ReportInput input;
  input.associated = associateByTime(truth, truth);
  input.evaluation = evaluate(input.associated);
  const std::string page = evaluationPage({"b.tum", "2026-01-02", {}}, {input}, evaluationFigures({input}));
  EXPECT_THAT(page,
              AllOf(HasSubstr("the path is too short"), HasSubstr("--odometry"), Not(HasSubstr("nan"))));
}

TEST(WriteFigures, WritesSvgAndPng) {
  const test::TemporaryFolder folder;
  writeFigures(folder.path(), evaluationFigures({inputOf(truthOf(40))}));
  for (const char* name : {"trajectory.svg", "trajectory.png", "nees.svg", "velocities.png"})
    EXPECT_TRUE(std::filesystem::is_regular_file(folder / name)) << name;
}

/// Header and one row of odometry.csv.
std::string odometryText(const std::string& valid, const std::string& x) {
  std::string header =
      "pair,utime_us,valid,reasons,reset_counter,offset_us,x_m,y_m,z_m,qw,qx,qy,qz,vx_m_s,vy_m_s,"
      "vz_m_s,wx_rad_s,wy_rad_s,wz_rad_s";
  std::string row = "0,1000000," + valid + ",0,0,0," + x + ",0,0,1,0,0,0,1,2,3,4,5,6";
  for (const char* first : {"pose_covariance_x_x", "twist_covariance_vx_vx"}) {
    header += std::string(",") + first;
    row += ",";
    for (int i = 1; i < 21; ++i) {
      header += ",c" + std::to_string(i);
      row += ",0.5";
    }
  }
  for (const char* quantity : {"velocity", "angular_rate", "motion", "rotation"}) {
    const std::string name = std::string(",") + quantity + "_bound_";
    header += name + "x" + name + "y" + name + "z";
    row += ",0.1,0.2,0.3";
  }
  return header + ",features\n" + row + ",7\n";
}

std::string readError(const test::TemporaryFolder& folder, const std::string& text) {
  std::ofstream(folder / "odometry.csv") << text;
  return test::messageOf([&] { readOdometryFile(folder / "odometry.csv"); });
}

TEST(OdometryFile, IsReadByTheNamesOfItsColumns) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "odometry.csv") << odometryText("1", "2.5");
  const std::vector<OdometryRow> rows = readOdometryFile(folder / "odometry.csv");
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].time_ns, 1'000'000'000);
  EXPECT_TRUE(rows[0].valid);
  EXPECT_DOUBLE_EQ(rows[0].T_world_body.translation().x(), 2.5);
  EXPECT_DOUBLE_EQ(rows[0].twist[5], 6.0);
  EXPECT_TRUE(std::isnan(rows[0].pose_covariance(0, 0))) << "an empty cell";
  EXPECT_DOUBLE_EQ(rows[0].pose_covariance(5, 4), 0.5);
  EXPECT_DOUBLE_EQ(rows[0].bound.angular_rate.y(), 0.2);
}

TEST(OdometryFile, IsKnownByItsFirstLine) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "odometry.csv") << odometryText("1", "2.5");
  std::ofstream(folder / "truth.tum") << "1 0 0 0 0 0 0 1\n";
  EXPECT_TRUE(isOdometryFile(folder / "odometry.csv"));
  EXPECT_FALSE(isOdometryFile(folder / "truth.tum"));
  EXPECT_FALSE(isOdometryFile(folder / "absent.csv"));
}

TEST(OdometryFile, GivesAPathThatContinuesAcrossEpochs) {
  std::vector<OdometryRow> rows = messagesOf(truthOf(6), 0.0, 3);
  for (std::size_t i = 4; i < 6; ++i) {  // a new epoch begins at the last known pose
    rows[i].reset_counter = 1;
    rows[i].T_world_body =
        Eigen::Isometry3d(Eigen::Translation3d(0.1 * static_cast<double>(i - 3), 0.0, 0.0));
  }
  rows[3].bound = {};
  const Trajectory path = bodyTrajectory(rows);
  ASSERT_EQ(path.size(), 6u);
  EXPECT_TRUE(path[3].pose.isApprox(path[2].pose)) << "the message has no estimate";
  EXPECT_NEAR((path[5].pose.translation() - path[2].pose.translation()).norm(), 0.2, 1e-12);
}

TEST(OdometryFile, ErrorsNameFileLineAndWhatWasExpected) {
  const test::TemporaryFolder folder;
  EXPECT_THAT(readError(folder, ""), HasSubstr("no rows"));
  EXPECT_THAT(readError(folder, "pair,valid\n"),
              AllOf(HasSubstr("odometry.csv:1: "), HasSubstr("'utime_us'")));
  EXPECT_THAT(readError(folder, odometryText("1", "x")), AllOf(HasSubstr(":2: "), HasSubstr("'x'")));
  EXPECT_THAT(readError(folder, odometryText("1", "inf")), HasSubstr("position"));
  EXPECT_THAT(readError(folder, odometryText("1", "1,2")), HasSubstr("columns"));
}

TEST(ComparedMessages, NeedTheMountForATruthOfTheCamera) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "odometry.csv") << odometryText("1", "0");
  std::ofstream(folder / "truth.txt") << "1 0 0 0 0 1 0 0 0 0 1 0\n";
  const auto compare = [&] { compareMessages(folder / "odometry.csv", folder / "truth.txt", 0); };
  EXPECT_THAT(test::messageOf(compare), HasSubstr("summary.json"));
  std::ofstream(folder / "summary.json") << "{\"rig\": {\"T_body_camera\": [1, 2]}}";
  EXPECT_THAT(test::messageOf(compare), HasSubstr("T_body_camera"));
}

}  // namespace
}  // namespace cartvo
