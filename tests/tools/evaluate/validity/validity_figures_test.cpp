// The measure of VALID messages: errors above a limit, above the stated bound, and the time without any.
#include "tools/evaluate/validity/validity_figures.hpp"

#include <cmath>
#include <fstream>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/temporary_folder.hpp"
#include "support/tools/run_cartvo.hpp"
#include "tools/replay/odometry_csv.hpp"

namespace cartvo {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr std::int64_t kPeriod_ns = 100'000'000;
constexpr double kSpeed = 2.0;      // m/s
constexpr std::size_t kBefore = 2;  // true poses before the first message

std::int64_t instantOf(std::size_t index) {
  return static_cast<std::int64_t>(index) * kPeriod_ns;
}

Eigen::Isometry3d poseAt(std::size_t index) {
  return Eigen::Isometry3d(Eigen::Translation3d(0.1 * kSpeed * static_cast<double>(index), 0.0, 0.0));
}

Trajectory truth() {
  Trajectory truth;
  for (std::size_t i = 0; i < 60; ++i)
    truth.push_back({instantOf(i), poseAt(i)});
  return truth;
}

/// Messages of a straight drive that say the truth, with bounds of 0.2 m/s, rad/s, m and rad.
std::vector<OdometryRow> messages(std::size_t count) {
  const Eigen::Vector3d bound = Eigen::Vector3d::Constant(0.2);
  std::vector<OdometryRow> rows(count);
  for (std::size_t i = 0; i < count; ++i) {
    rows[i].time_ns = instantOf(i + kBefore);
    rows[i].valid = true;
    rows[i].T_world_body = poseAt(i);
    rows[i].twist << kSpeed, 0, 0, 0, 0, 0;
    rows[i].bound = {bound, bound, bound, bound};
  }
  return rows;
}

ValidityFigures figuresOf(const std::vector<OdometryRow>& rows) {
  constexpr pipeline::AlertLimits kLimits{0.3, 0.05, 0.15, 0.025};
  return validityFigures(judge(rows, trueStates(rows, truth())), kLimits);
}

TEST(ValidityFigures, CountALargeErrorHoweverUncertainItIsSaidToBe) {
  std::vector<OdometryRow> rows = messages(50);
  rows[20].twist[0] += 1.0;
  rows[20].twist_covariance = 1e4 * vo::Matrix6d::Identity();  // (100 m/s)^2
  rows[20].bound.velocity.setConstant(500.0);
  const ValidityFigures figures = figuresOf(rows);
  EXPECT_EQ(figures.above_limit, 1u);
  EXPECT_EQ(figures.above_bound, 0u);
  EXPECT_NEAR(figures.velocity_error, 1.0, 1e-9);
}

TEST(ValidityFigures, DoNotCountAnErrorWithinItsBound) {
  std::vector<OdometryRow> rows = messages(50);
  for (OdometryRow& row : rows)
    row.twist[1] += 0.15;
  const ValidityFigures figures = figuresOf(rows);
  EXPECT_EQ(figures.judged, 50u);
  EXPECT_EQ(figures.above_limit + figures.above_bound, 0u);
  EXPECT_NEAR(figures.velocity_error, 0.15, 1e-9);
}

TEST(ValidityFigures, CountEachComponentAgainstItsOwnBound) {
  std::vector<OdometryRow> rows = messages(50);
  rows[10].twist[2] += 0.1;
  rows[10].bound.velocity.z() = 0.09;
  rows[11].twist[5] += 0.04;  // 2.3 deg/s
  rows[11].bound.angular_rate.z() = 0.03;
  rows[12].bound.velocity.x() = std::numeric_limits<double>::quiet_NaN();  // VALID, and states none
  rows[13].twist[5] += 0.06;                                               // 3.4 deg/s
  const ValidityFigures figures = figuresOf(rows);
  EXPECT_EQ(figures.above_bound, 3u);
  EXPECT_EQ(figures.above_limit, 1u);
  EXPECT_NEAR(figures.rate_error, 0.06, 1e-9);
}

TEST(ValidityFigures, CountAVelocityThatIsNoNumber) {
  std::vector<OdometryRow> rows = messages(50);
  rows[20].twist[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(figuresOf(rows).above_limit, 1u);
}

TEST(ValidityFigures, CountTheMotionOfTheLastSecond) {
  std::vector<OdometryRow> rows = messages(50);
  for (std::size_t i = 20; i < rows.size(); ++i)  // 18 cm too far in one step: for ten messages
    rows[i].T_world_body.translation().x() += 0.18;
  EXPECT_EQ(figuresOf(rows).above_limit, 10u);
  EXPECT_EQ(figuresOf(rows).above_bound, 0u);
  for (std::size_t i = 20; i < rows.size(); ++i)  // a new epoch has no motion from the old one
    rows[i].reset_counter = 1;
  EXPECT_EQ(figuresOf(rows).above_limit, 0u);
}

TEST(ValidityFigures, LeaveOutMessagesThatAreNotValidAndHaveNoTruth) {
  std::vector<OdometryRow> rows = messages(50);
  rows[10].valid = false;
  rows[10].twist.setConstant(100.0);
  const std::vector<JudgedMessage> judged = judge(rows, std::vector<TrueState>(rows.size()));
  EXPECT_EQ(validityFigures(judged, {}).judged, 0u);
  EXPECT_EQ(validityFigures(judged, {}).valid, 49u);
  EXPECT_EQ(figuresOf(rows).above_limit, 0u);
}

TEST(ValidityFigures, MeasureAvailabilityAndTheLongestGap) {
  std::vector<OdometryRow> rows = messages(41);
  EXPECT_NEAR(figuresOf(rows).longest_gap, 0.1, 1e-9) << "a period";
  for (const std::size_t i : {0, 1, 2, 20, 21, 22, 23, 40})
    rows[i].valid = false;
  const ValidityFigures figures = figuresOf(rows);
  EXPECT_NEAR(figures.availability(), 33.0 / 41.0, 1e-12);
  EXPECT_NEAR(figures.longest_gap, 0.5, 1e-9) << "from message 19 to 24";
  rows.erase(rows.begin() + 25, rows.begin() + 35);  // pairs that never came
  EXPECT_NEAR(figuresOf(rows).longest_gap, 1.1, 1e-9);
  for (OdometryRow& row : rows)
    row.valid = false;
  EXPECT_NEAR(figuresOf(rows).longest_gap, 4.0, 1e-9);
  EXPECT_EQ(ValidityFigures{}.availability(), 0.0);
}

/// Writes what a replay writes of a straight drive whose message 20 is off by 1 m/s and states 100 m/s.
void writeDrive(const std::filesystem::path& folder) {
  Replay replay;
  for (const OdometryRow& row : messages(50)) {
    ReplayedPair& pair = replay.pairs.emplace_back();
    odometry_t& message = pair.message;
    const std::size_t index = replay.pairs.size() - 1;
    message.utime = row.time_ns / 1000;
    message.status = odometry_t::VALID;
    message.position_world_body[0] = row.T_world_body.translation().x();
    message.orientation_world_body[0] = 1.0;
    message.velocity_body[0] = kSpeed + (index == 20 ? 1.0 : 0.0);
    for (double* bound :
         {message.velocity_bound, message.angular_rate_bound, message.motion_bound, message.rotation_bound})
      std::fill(bound, bound + 3, index == 20 ? 100.0 : 0.1);
  }
  std::ofstream(folder / "odometry.csv") << odometryCsv(replay);
  writeTum(folder / "truth.tum", truth(), TrajectoryFrame::body);
}

TEST(EvaluateCommand, JudgesTheMessagesOfAnOdometryFile) {
  const test::TemporaryFolder folder;
  writeDrive(folder.path());
  const std::string files = (folder / "odometry.csv").string() + " " + (folder / "truth.tum").string();
  const test::CommandResult text = test::runCartvo("evaluate " + files);
  EXPECT_EQ(text.exit_code, 0);
  EXPECT_THAT(text.output, AllOf(HasSubstr("VALID above an alert limit         1 of 50 (0.7 m/s, 12 deg/s"),
                                 HasSubstr("VALID above their bound            0 of 50"),
                                 HasSubstr("50 of 50, 100.00 %, longest gap 0.10 s")));
  const test::CommandResult wide = test::runCartvo("evaluate --json --alert-limits 2,3,0.15,1.5 --messages " +
                                                   (folder / "m.csv").string() + " " + files);
  EXPECT_THAT(wide.output, AllOf(HasSubstr("\"above_limit\": 0"), HasSubstr("\"judged_messages\": 50")));
  std::ifstream csv(folder / "m.csv");
  std::string line;
  for (int i = 0; i < 22; ++i)
    std::getline(csv, line);
  EXPECT_THAT(line, ::testing::StartsWith("2200000,1,1,")) << "message 20, behind the header";
}

}  // namespace
}  // namespace cartvo
