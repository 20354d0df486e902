// Trajectories in TUM and KITTI format: reading, writing, errors.

#include "tools/trajectory/trajectory.hpp"

#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"

namespace cartvo {
namespace {

using ::testing::HasSubstr;

void write(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file) << text;
}

std::string messageOfReading(const std::filesystem::path& file) {
  return test::messageOf([&] { readTrajectory(file); });
}

Trajectory helix() {
  Trajectory trajectory;
  for (int i = 0; i < 5; ++i) {
    StampedPose stamped;
    stamped.time_ns = 1'403'715'273'262'142'976 + i * 55'555'555;
    stamped.pose.linear() =
        Eigen::AngleAxisd(0.7 * i, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    stamped.pose.translation() = Eigen::Vector3d(i, -0.5 * i, 0.001 * i);
    trajectory.push_back(stamped);
  }
  return trajectory;
}

TEST(Trajectory, TumFormatKeepsPosesAndTimesToTheNanosecond) {
  const test::TemporaryFolder folder;
  writeTum(folder / "a.tum", helix());
  const Trajectory read = readTrajectory(folder / "a.tum");
  ASSERT_EQ(read.size(), 5u);
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].time_ns, helix()[i].time_ns);
    EXPECT_TRUE(read[i].pose.isApprox(helix()[i].pose, 1e-8));
  }
  EXPECT_FALSE(isKittiTrajectory(folder / "a.tum"));
}

TEST(Trajectory, KittiFormatKeepsPosesAndUsesRowIndexAsTime) {
  const test::TemporaryFolder folder;
  writeKitti(folder / "a.txt", helix());
  const Trajectory read = readTrajectory(folder / "a.txt");
  ASSERT_EQ(read.size(), 5u);
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].time_ns, static_cast<std::int64_t>(i));
    EXPECT_TRUE(read[i].pose.isApprox(helix()[i].pose, 1e-8));
  }
  EXPECT_TRUE(isKittiTrajectory(folder / "a.txt"));
}

TEST(Trajectory, FirstLineStatesTheFrame) {
  const test::TemporaryFolder folder;
  writeTum(folder / "body.tum", helix(), TrajectoryFrame::body);
  writeTum(folder / "camera.tum", helix(), TrajectoryFrame::left_camera);
  writeTum(folder / "unmounted.tum", helix(), TrajectoryFrame::unmounted_camera);
  writeKitti(folder / "kitti.txt", helix());
  write(folder / "stated.txt",
        "# poses of the cart's body (x forward, y left, z up): rows\n1 0 0 0 0 1 0 0 0 0 1 0\n");
  write(folder / "other.tum", "# seconds x y z qx qy qz qw\n0 0 0 0 0 0 0 1\n");
  EXPECT_EQ(frameOf(folder / "body.tum"), TrajectoryFrame::body);
  EXPECT_EQ(frameOf(folder / "camera.tum"), TrajectoryFrame::left_camera);
  EXPECT_EQ(frameOf(folder / "unmounted.tum"), TrajectoryFrame::unmounted_camera);
  EXPECT_EQ(frameOf(folder / "kitti.txt"), TrajectoryFrame::left_camera) << "by definition";
  EXPECT_EQ(frameOf(folder / "stated.txt"), TrajectoryFrame::body) << "as earlier releases wrote it";
  EXPECT_EQ(frameOf(folder / "other.tum"), TrajectoryFrame::unknown);
}

TEST(Trajectory, ReadsCommentsEmptyLinesAndAnyTimeNotation) {
  const test::TemporaryFolder folder;
  write(folder / "a.tum",
        "# seconds x y z qx qy qz qw\n\n-0.5 0 0 0 0 0 0 1\n0 0 0 0 0 0 0 1 # here\r\n.25 0 0 0 0 0 0 1\n"
        "1.5e0 0 0 0 0 0 0 1\n2.123456789123 0 0 0 0 0 0 1\n");
  const Trajectory read = readTrajectory(folder / "a.tum");
  std::vector<std::int64_t> instants;
  for (const StampedPose& stamped : read)
    instants.push_back(stamped.time_ns);
  EXPECT_THAT(instants, ::testing::ElementsAre(-500'000'000, 0, 250'000'000, 1'500'000'000, 2'123'456'789));
}

TEST(Trajectory, ReadsBackNegativeTimes) {
  const test::TemporaryFolder folder;
  writeTum(folder / "a.tum", {{-1'250'000'001, Eigen::Isometry3d::Identity()}});
  const Trajectory read = readTrajectory(folder / "a.tum");
  ASSERT_FALSE(read.empty());
  EXPECT_EQ(read.front().time_ns, -1'250'000'001);
}

TEST(Trajectory, ReadsEurocsGroundTruth) {
  const test::TemporaryFolder folder;
  const Eigen::Quaterniond q(0.8, 0.0, 0.6, 0.0);
  for (const std::string rest : {"", ",1,2,3,4,5,6,7,8,9"}) {
    write(folder / "a.csv",
          "#timestamp, p_RS_R_x [m], ..., q_RS_w [], q_RS_x []\n1403636579763555584,1,2,3,0.8,0,0.6,0" +
              rest + "\r\n");
    const Trajectory read = readTrajectory(folder / "a.csv");
    ASSERT_EQ(read.size(), 1U);
    EXPECT_EQ(read[0].time_ns, 1403636579763555584);
    EXPECT_EQ(read[0].pose.translation(), Eigen::Vector3d(1, 2, 3));
    EXPECT_TRUE(read[0].pose.linear().isApprox(q.toRotationMatrix(), 1e-12));
    EXPECT_FALSE(isKittiTrajectory(folder / "a.csv"));
  }
}

TEST(Trajectory, ReadsCommasByteOrderMarksAndColumnNames) {
  const test::TemporaryFolder folder;
  const Eigen::Quaterniond q(0.8, 0.0, 0.6, 0.0);
  for (const std::string text :
       {"1.5,1,2,3,0,0.6,0,0.8\n", "1.5, 1, 2, 3, 0, 0.6, 0, 0.8\n",
        "\xEF\xBB\xBF"
        "1.5 1 2 3 0 0.6 0 0.8\n",
        "# time px py pz qw qx qy qz\n1.5 1 2 3 0.8 0 0.6 0\n",
        "timestamp tx ty tz qx qy qz qw\n1.5 1 2 3 0 0.6 0 0.8\n",
        "\"time\",\"x\",\"y\",\"z\",\"qw\",\"qx\",\"qy\",\"qz\"\n1.5,1,2,3,0.8,0,0.6,0\n",
        "% t x y z qx qy qz qw\n// of a tool\n1.5 1 2 3 0 0.6 0 0.8\n",
        "Zeit;x;y;z;qx;qy;qz;qw\n1,5;1;2,0;3;0;0,6;0;0,8\n"}) {
    write(folder / "a.tum", text);
    const Trajectory read = readTrajectory(folder / "a.tum");
    ASSERT_EQ(read.size(), 1U) << text;
    EXPECT_EQ(read[0].time_ns, 1'500'000'000);
    EXPECT_TRUE(read[0].pose.linear().isApprox(q.toRotationMatrix(), 1e-12)) << text;
  }
}

struct BadTrajectory {
  std::string name, text, message;
};
void PrintTo(const BadTrajectory& bad, std::ostream* stream) {
  *stream << bad.name;
}

class BadTrajectoryFile : public ::testing::TestWithParam<BadTrajectory> {};

TEST_P(BadTrajectoryFile, IsRejectedWithLineNumber) {
  const test::TemporaryFolder folder;
  write(folder / "a.txt", GetParam().text);
  EXPECT_THAT(messageOfReading(folder / "a.txt"),
              HasSubstr((folder / "a.txt").string() + GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    , BadTrajectoryFile,
    ::testing::Values(
        BadTrajectory{"WrongCount", "0 1 2\n",
                      ":1: expected 8 numbers (TUM: seconds x y z qx qy qz qw), 12 (KITTI: a 3x4 matrix)"},
        BadTrajectory{"MixedFormats", "0 0 0 0 0 0 0 1\n1 0 0 0 0 1 0 0 0 0 1 0\n",
                      ":2: expected 8 numbers as in the rows before, found 12"},
        BadTrajectory{"NoNumber", "# x\n0 0 zero 0 0 0 0 1\n",
                      ":2: expected a number in column 3, found 'zero'"},
        BadTrajectory{"NotFinite", "0 0 nan 0 0 0 0 1\n", ":1: expected a number in column 3, found 'nan'"},
        BadTrajectory{"NoQuaternion", "0 0 0 0 1 1 1 1\n", ":1: expected a unit quaternion"},
        BadTrajectory{"NoRotation", "1 0 0 0 0 1 0 0 0 0 2 0\n", ":1: expected the rows of a 3x4 pose"},
        BadTrajectory{"TimeNotIncreasing", "0 0 0 0 0 0 0 1\n0 0 0 0 0 0 0 1\n",
                      ":2: expected instants that increase"},
        BadTrajectory{"InstantTooLarge", "1e300 0 0 0 0 0 0 1\n", ":1: expected an instant in seconds"},
        BadTrajectory{"TooFar", "0 0 -7e150 0 0 0 0 1\n", ":1: expected metres in column 3, at most 1e9"},
        BadTrajectory{"EscapeCharacters", "0 \x1B[31m 0 0 0 0 0 1\n",
                      ":1: expected a number in column 2, found '\\x1b[31m'"},
        BadTrajectory{"Nanoseconds", "1403636579763555584 0 0 0 0 0 0 1\n",
                      ":1: expected an instant in seconds, found '1403636579763555584': in milliseconds"},
        BadTrajectory{"EurocInstant", "#timestamp\n1.5,0,0,0,1,0,0,0,0,0,0,0,0,0,0,0,0\n",
                      ":2: expected an instant in nanoseconds, found '1.5'"},
        BadTrajectory{"Empty", "# nothing\n", ": contains no poses"}),
    [](const auto& test_case) { return test_case.param.name; });

TEST(Trajectory, ErrorNamesMissingFile) {
  EXPECT_THAT(messageOfReading("/no/such/poses.txt"), HasSubstr("/no/such/poses.txt: cannot be read"));
}

}  // namespace
}  // namespace cartvo
