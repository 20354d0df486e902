#pragma once

#include <vector>

#include "support/vo_core/synthetic_texture.hpp"
#include "vo_core/estimation/bundle_adjustment.hpp"
#include "vo_core/geometry/reprojection.hpp"
#include "vo_core/geometry/rig_correction.hpp"
#include "vo_core/rigid_motion.hpp"

namespace cartvo::test {

inline const vo::StereoCamera kRigCamera{480.0, 340.0, 210.0, 0.115, 680, 420};
constexpr double kFramePeriod = 0.055;  // s

inline vo::BundleResult adjustBundle(vo::BundleProblem& problem, const vo::BundleSettings& settings) {
  return vo::BundleAdjuster().adjust(problem, settings);
}

/// Motion vector (x, y, z, rotation vector); m and rad.
inline vo::Vector6d vector6(double x, double y, double z, double rx, double ry, double rz) {
  vo::Vector6d vector;
  vector << x, y, z, rx, ry, rz;
  return vector;
}

/// Pose at `time` (s) of a drive with constant linear and angular velocity, as the estimator assumes between
/// two pairs, so that a time offset adds no model error.
inline Eigen::Isometry3d steadyDrive(double time) {
  return vo::motionFromVector(time * vector6(0.1, -0.05, 2.7, 0.02, -0.3, 0.05));
}

inline Eigen::Isometry3d rightOf(const Eigen::Isometry3d& T_world_left) {
  Eigen::Isometry3d T = T_world_left;
  T.translation() += T.linear().col(0) * kRigCamera.baseline;
  return T;
}

inline bool inView(const Eigen::Vector2d& pixel) {
  return pixel.x() >= 0.0 && pixel.y() >= 0.0 && pixel.x() < kRigCamera.width &&
         pixel.y() < kRigCamera.height;
}

/// Pixel at which a right camera with the calibration error `rig` sees the point that a calibrated one sees
/// at `pixel`.
inline Eigen::Vector2d miscalibratedPixel(const vo::RigCorrection& rig, const Eigen::Vector2d& pixel) {
  Eigen::Vector2d seen = pixel;
  for (int i = 0; i < 5; ++i)  // inverts correctedRight() by iteration
    seen += pixel - vo::correctedRight(kRigCamera, rig, seen);
  return seen;
}

/// Window of pairs in a static world.
struct LandmarkScene {
  int frames = 7;
  int free_frames = 1;
  int landmarks = 70;
  double offset = 0.0;        ///< s, time offset of every pair
  double noise = 0.0;         ///< in units of the assumed noise
  double coarse_noise = 0.0;  ///< the same for every other landmark, which has level 1; 0: no such landmarks
  double wrong_disparities = 0.0;  ///< fraction of stereo matches with a wrong disparity
  vo::RigCorrection rig{};         ///< error of the calibration
  double delay = 0.0;              ///< s, right exposure minus the one by `offset`
};

/// Simulates a problem whose initial values are the truth.
inline vo::BundleProblem simulateProblem(const LandmarkScene& scene, std::uint64_t seed) {
  Noise random(seed);
  Noise random_rows(seed + 1'000'000);
  vo::BundleProblem problem;
  problem.camera = kRigCamera;
  problem.fixed = scene.frames - scene.free_frames;
  for (int i = 0; i < scene.frames; ++i)
    problem.poses.push_back({i * kFramePeriod, scene.offset, steadyDrive(i * kFramePeriod)});

  const auto observe = [&](vo::BundleLandmark& landmark, int frame, const Eigen::Vector3d& world) {
    const bool is_anchor = landmark.observations.empty();
    const vo::TimedPose& pose = problem.poses[frame];
    const Eigen::Vector3d in_left = pose.T_world_camera.inverse() * world;
    const Eigen::Vector3d in_right =
        rightOf(steadyDrive(pose.time + pose.offset + scene.delay)).inverse() * world;
    if (in_left.z() < 0.5 || in_right.z() < 0.5 || !inView(vo::project(kRigCamera, in_left))) return;
    const Eigen::Vector2d left = vo::project(kRigCamera, in_left);
    const Eigen::Vector2d right = miscalibratedPixel(scene.rig, vo::project(kRigCamera, in_right));
    const double disparity = left.x() - right.x();
    const vo::BundleNoise& assumed = problem.noise[landmark.level];
    const double stddev = assumed.disparity + assumed.stretch * std::abs(disparity);
    const double noise = landmark.level > 0 ? scene.coarse_noise : scene.noise;

    vo::BundleObservation observation;
    observation.pose = frame;
    observation.left = left;
    if (!is_anchor)  // the anchor position defines the landmark
      for (int axis = 0; axis < 2; ++axis)
        observation.left[axis] += noise * assumed.pixel * random.gaussian();
    double measured = disparity + noise * stddev * random.gaussian();
    if (random.uniform() < scene.wrong_disparities) measured += 5.0 + 30.0 * random.uniform();
    observation.stereo = true;
    const double rows = left.y() - right.y() + noise * assumed.pixel * random_rows.gaussian();
    observation.right = observation.left - Eigen::Vector2d(measured, rows);
    landmark.observations.push_back(observation);
  };

  for (int i = 0; i < scene.landmarks; ++i) {
    const int anchor = i % (scene.frames - 1);
    vo::BundleLandmark landmark;
    if (scene.coarse_noise > 0.0) landmark.level = i % 2;
    const double column = kRigCamera.width * random.uniform();
    const double row = kRigCamera.height * random.uniform();
    landmark.bearing = vo::bearingOf(kRigCamera, {column, row});
    landmark.inverse_depth = 1.0 / 30.0 + 0.3 * random.uniform();
    const Eigen::Vector3d world =
        problem.poses[anchor].T_world_camera * (landmark.bearing / landmark.inverse_depth);
    for (int frame = anchor; frame < scene.frames; ++frame)
      observe(landmark, frame, world);
    if (landmark.observations.size() > 1) problem.landmarks.push_back(landmark);
  }
  return problem;
}

/// Adds errors to the initial values; `size` 1 is the error after a pose search.
inline void disturb(vo::BundleProblem& problem, double size = 1.0) {
  for (std::size_t i = static_cast<std::size_t>(problem.fixed); i < problem.poses.size(); ++i) {
    Eigen::Isometry3d& pose = problem.poses[i].T_world_camera;
    pose = pose * vo::motionFromVector(size * vector6(0.01, -0.01, 0.02, 0.002, -0.003, 0.002));
  }
  for (std::size_t i = 0; i < problem.landmarks.size(); ++i)
    problem.landmarks[i].inverse_depth *= 1.0 + size * (i % 2 == 0 ? 0.1 : -0.08);
}

/// Errors of the free poses relative to steadyDrive(), oldest first; perturbations on the right.
inline Eigen::VectorXd poseErrors(const vo::BundleProblem& problem) {
  const int free = static_cast<int>(problem.poses.size()) - problem.fixed;
  Eigen::VectorXd errors(6 * free);
  for (int i = 0; i < free; ++i) {
    const vo::TimedPose& pose = problem.poses[problem.fixed + i];
    errors.segment<6>(6 * i) = vo::vectorFromMotion(steadyDrive(pose.time).inverse() * pose.T_world_camera);
  }
  return errors;
}

}  // namespace cartvo::test
