// Ground plane estimation on synthetic images of a plane. Mount estimation from simulated drives with known
// truth, and `cartvo calibrate mount`.
#include "tools/calibrate/mount/mount.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "calib/format/rig_file.hpp"
#include "common/units.hpp"
#include "lab/render/rendered_world.hpp"
#include "support/error_message.hpp"
#include "support/lab/tiny_world.hpp"
#include "support/temporary_folder.hpp"
#include "support/tools/run_cartvo.hpp"
#include "tools/calibrate/mount/ground_plane.hpp"
#include "tools/simulate/content_files.hpp"

namespace cartvo::calibrate {
namespace {

using testing::HasSubstr;

calib::Rectification cameras() {
  calib::Rectification rectification;
  rectification.size = {640, 400};
  rectification.focal_length = 480.0;
  rectification.cx = 319.5;
  rectification.cy = 180.0;
  rectification.baseline = 0.12;
  return rectification;
}

/// Non-repeating waves on the plane, with wavelengths from 5 cm.
double brightness(double x, double z) {
  return 128.0 + 25.0 * std::sin(31.0 * x + 11.0 * z) + 25.0 * std::sin(-47.3 * x + 59.7 * z) +
         20.0 * std::sin(97.1 * x - 23.9 * z) + 20.0 * std::sin(9.7 * x + 121.3 * z);
}

/// Image of the plane down . X = height from a camera at (x, 0, 0); grey beyond 15 m.
cv::Mat view(const calib::Rectification& rectification, double x, const Eigen::Vector3d& down,
             double height) {
  constexpr double kMaxDepth = 15.0;  // m
  cv::Mat image(rectification.size, CV_8UC1, cv::Scalar(128));
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      const Eigen::Vector3d ray((column - rectification.cx) / rectification.focal_length,
                                (row - rectification.cy) / rectification.focal_length, 1.0);
      const double depth = (height - x * down.x()) / ray.dot(down);
      if (!(depth > 0.0 && depth < kMaxDepth)) continue;
      image.at<std::uint8_t>(row, column) =
          static_cast<std::uint8_t>(std::lround(brightness(x + depth * ray.x(), depth)));
    }
  }
  return image;
}

TEST(GroundPlane, IsEstimatedWithHeightAndNormal) {
  const calib::Rectification rectification = cameras();
  const Eigen::Vector3d down =
      Eigen::Vector3d(0.03, 1.0, 0.14).normalized();  // pitched down, slightly rolled
  const double height = 1.8;
  const auto ground = findGround(view(rectification, 0.0, down, height),
                                 view(rectification, rectification.baseline, down, height), rectification);
  ASSERT_TRUE(ground);
  EXPECT_NEAR(ground->height, height, 0.002);
  EXPECT_LT((ground->down - down).norm(), 0.0003);
  EXPECT_GT(ground->points, 2000);
}

TEST(GroundPlane, RejectsAWall) {
  const calib::Rectification rectification = cameras();
  cv::Mat left(rectification.size, CV_8UC1), right(rectification.size, CV_8UC1);
  constexpr double kDepth = 4.0;
  const double shift = rectification.focal_length * rectification.baseline / kDepth;
  for (int row = 0; row < left.rows; ++row) {
    for (int column = 0; column < left.cols; ++column) {
      const auto wave = [&](double x) { return static_cast<std::uint8_t>(brightness(x / 90.0, row / 90.0)); };
      left.at<std::uint8_t>(row, column) = wave(column);
      right.at<std::uint8_t>(row, column) = wave(column + shift);
    }
  }
  EXPECT_FALSE(findGround(left, right, rectification));
}

TEST(GroundPlane, RejectsAnEmptyImage) {
  const cv::Mat grey(cameras().size, CV_8UC1, cv::Scalar(90));
  EXPECT_FALSE(findGround(grey, grey, cameras()));
}

constexpr double kYaw = 2.0 * kRadiansPerDegree, kPitch = 8.0 * kRadiansPerDegree,
                 kRoll = -1.0 * kRadiansPerDegree;

Eigen::Isometry3d trueMount() {
  Eigen::Isometry3d T_body_camera = Eigen::Isometry3d::Identity();
  T_body_camera.linear() = (Eigen::AngleAxisd(kYaw, Eigen::Vector3d::UnitZ()) *
                            Eigen::AngleAxisd(kPitch, Eigen::Vector3d::UnitY()) *
                            Eigen::AngleAxisd(kRoll, Eigen::Vector3d::UnitX()) *
                            Eigen::Quaterniond(calib::forwardLookingMount().linear()))
                               .toRotationMatrix();
  T_body_camera.translation() = Eigen::Vector3d(1.5, 0.1, 1.9);
  return T_body_camera;
}

/// The mount as known before: x and y of the camera, looking forward.
Eigen::Isometry3d knownMount() {
  Eigen::Isometry3d mount = calib::forwardLookingMount();
  mount.translation() = Eigen::Vector3d(1.5, 0.1, 0.0);
  return mount;
}

/// Ground observations each eighth of a second, while the cart sways by some tenths of a degree.
std::vector<GroundObservation> groundObservations(double seconds) {
  std::vector<GroundObservation> all;
  const Eigen::Matrix3d R_camera_body = trueMount().linear().transpose();
  for (double t = 0.0; t < seconds; t += 0.125) {
    const Eigen::Matrix3d sway =
        (Eigen::AngleAxisd(0.3 * kRadiansPerDegree * std::sin(5.0 * t), Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(0.2 * kRadiansPerDegree * std::sin(7.0 * t), Eigen::Vector3d::UnitX()))
            .toRotationMatrix();
    all.push_back({t, R_camera_body * (sway * -Eigen::Vector3d::UnitZ()), 1.9 + 0.01 * std::sin(3.0 * t)});
  }
  return all;
}

/// Twist of the camera on a body that moves without sideslip at its origin.
CameraTwist twistAt(double seconds, double speed, double yaw_rate) {
  const Eigen::Isometry3d T_body_camera = trueMount();
  const Eigen::Vector3d omega(0.0, 0.0, yaw_rate);
  const Eigen::Vector3d velocity =
      Eigen::Vector3d(speed, 0.0, 0.0) + omega.cross(T_body_camera.translation());
  const Eigen::Matrix3d R_camera_body = T_body_camera.linear().transpose();
  return {seconds, R_camera_body * velocity, R_camera_body * omega};
}

void expectTrueAttitude(const Mount& mount, double tolerance) {
  const Eigen::AngleAxisd error(trueMount().linear().transpose() * mount.T_body_camera.linear());
  EXPECT_LT(error.angle(), tolerance) << "about " << error.axis().transpose();
}

TEST(Mount, IsEstimatedFromADriveInCurves) {
  std::vector<CameraTwist> motions;
  for (double t = 0.0; t < 20.0; t += 0.1)
    motions.push_back(twistAt(t, 4.0, 0.15 + 0.3 * std::sin(0.5 * t)));  // more to the left than to the right
  motions.push_back({20.0, {5.0, 0.0, 3.0}, {0.0, 0.0, 0.0}});           // an outlier
  const Mount mount = measureMount(groundObservations(20.0), motions, knownMount());
  expectTrueAttitude(mount, 0.05 * kRadiansPerDegree);
  EXPECT_NEAR(mount.height.value, 1.9, 0.005);
  ASSERT_TRUE(mount.yaw);
  EXPECT_NEAR(mount.yaw->value, kYaw, 0.02 * kRadiansPerDegree);
  EXPECT_NEAR(mount.pitch.value, kPitch, 0.1 * kRadiansPerDegree);
  EXPECT_NEAR(mount.roll.value, kRoll, 0.1 * kRadiansPerDegree);
  ASSERT_TRUE(mount.ahead_of_axle);
  EXPECT_NEAR(mount.ahead_of_axle->value, 1.5, 0.05);
  EXPECT_EQ(mount.T_body_camera.translation().head<2>(), Eigen::Vector2d(1.5, 0.1));
}

TEST(Mount, IsEstimatedFromAStraightDriveForwardAndBackward) {
  std::vector<CameraTwist> motions;
  for (double t = 0.0; t < 10.0; t += 0.1)
    motions.push_back(twistAt(t, t < 5.0 ? 3.0 : -2.0, 0.0));
  const Mount mount = measureMount(groundObservations(10.0), motions, knownMount());
  expectTrueAttitude(mount, 0.1 * kRadiansPerDegree);
  EXPECT_FALSE(mount.ahead_of_axle);
}

TEST(Mount, KeepsTheKnownYawWithoutADrive) {
  std::vector<CameraTwist> motions;
  for (double t = 0.0; t < 10.0; t += 0.1)
    motions.push_back(twistAt(t, 0.01, 0.3));
  Eigen::Isometry3d known = knownMount();
  known.prerotate(Eigen::AngleAxisd(5.0 * kRadiansPerDegree, Eigen::Vector3d::UnitZ()));
  const Mount mount = measureMount(groundObservations(10.0), motions, known);
  EXPECT_FALSE(mount.yaw);
  EXPECT_NEAR(mount.pitch.value, kPitch, 0.2 * kRadiansPerDegree);
  const Eigen::Vector3d axis = mount.T_body_camera.linear().col(2);
  EXPECT_NEAR(std::atan2(axis.y(), axis.x()), 5.0 * kRadiansPerDegree, 0.2 * kRadiansPerDegree);
}

TEST(Mount, StddevsMatchTheErrors) {
  std::vector<CameraTwist> motions;
  for (double t = 0.0; t < 20.0; t += 0.1)
    motions.push_back(twistAt(t, 4.0 + std::sin(t), 0.02 * std::sin(3.0 * t)));
  const Mount mount = measureMount(groundObservations(20.0), motions, knownMount());
  EXPECT_LT(std::abs(mount.pitch.value - kPitch), 4.0 * mount.pitch.stddev);
  EXPECT_LT(std::abs(mount.roll.value - kRoll), 4.0 * mount.roll.stddev);
  EXPECT_LT(std::abs(mount.height.value - 1.9), 4.0 * mount.height.stddev);
  EXPECT_GT(mount.pitch.stddev, 0.0);
  EXPECT_LT(mount.pitch.stddev, 0.1 * kRadiansPerDegree);
}

TEST(Mount, RefusesTooFewGroundObservations) {
  EXPECT_THAT(test::messageOf([] { measureMount({}, {}, knownMount()); }),
              HasSubstr("the ground was found in 0 pairs only"));
}

/// End to end: a rendered drive whose rig file has no mount.
TEST(CalibrateMountCommand, EstimatesTheMountOfARenderedCart) {
  world::WorldSettings settings = test::tinyWorld();
  settings.seconds = 4.0;
  const world::RenderedWorld world(settings);
  const test::TemporaryFolder folder;
  simulate::renderFolder(folder / "drive", world, [](int, int) {});
  const Eigen::Isometry3d truth = world.rig().T_body_camera;
  calib::Rig rig = world.rig();
  rig.T_body_camera = calib::forwardLookingMount();
  calib::writeRig(folder / "drive/rig.yaml", rig);
  const test::CommandResult run =
      test::pipeCartvo("calibrate mount " + (folder / "drive").string() + " --forward 1.55 --json --output " +
                       (folder / "out.yaml").string());
  ASSERT_EQ(run.exit_code, 0) << run.output;
  const auto report = nlohmann::json::parse(run.output);
  EXPECT_NEAR(report["height_m"]["value"].get<double>(), 1.9, 0.03) << run.output;
  // The cart accelerates all the time, which raises its nose.
  EXPECT_NEAR(report["pitch_deg"]["value"].get<double>(), 7.0, 1.2) << run.output;
  EXPECT_NEAR(report["roll_deg"]["value"].get<double>(), -0.2, 0.4) << run.output;
  EXPECT_NEAR(report["yaw_deg"]["value"].get<double>(), 0.3, 0.3) << run.output;
  const Eigen::Isometry3d found = calib::readRig(folder / "out.yaml").T_body_camera;
  EXPECT_LT(Eigen::AngleAxisd(truth.linear().transpose() * found.linear()).angle(), 1.3 * kRadiansPerDegree);
  EXPECT_NEAR(found.translation().z(), report["height_m"]["value"].get<double>(), 1e-9);
  EXPECT_EQ(found.translation().x(), 1.55);
}

TEST(MountUncertainty, IncludesTheRoadWhichAveragesAlongTheDriveOnly) {
  Mount mount;
  mount.height.stddev = 0.001;
  mount.yaw = Estimate{0.0, 0.0};
  const Mount short_drive = withRoadUncertainty(mount, 9.0), long_drive = withRoadUncertainty(mount, 60.0);
  EXPECT_NEAR(short_drive.height.stddev, 0.0064, 1e-4);
  EXPECT_GT(short_drive.roll.stddev, 0.1 * kRadiansPerDegree);
  EXPECT_EQ(long_drive.roll.stddev, short_drive.roll.stddev);
  EXPECT_LT(long_drive.pitch.stddev, 0.5 * short_drive.pitch.stddev);
  EXPECT_LT(long_drive.yaw->stddev, short_drive.yaw->stddev);
  EXPECT_EQ(durationOf({{2.0}, {1.0}, {4.5}}), 3.5);
  EXPECT_EQ(durationOf({}), 0.0);
}

}  // namespace
}  // namespace cartvo::calibrate
