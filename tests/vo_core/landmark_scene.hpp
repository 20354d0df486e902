#pragma once

#include <vector>

#include "vo_core/bundle_adjustment.hpp"
#include "vo_core/reprojection.hpp"
#include "vo_core/rig_correction.hpp"
#include "vo_core/rigid_motion.hpp"
#include "vo_core/synthetic_texture.hpp"

namespace cartvo::test {

inline const StereoCamera kRigCamera{480.0, 340.0, 210.0, 0.115, 680, 420};
constexpr double kFramePeriod = 0.055;  // s

inline BundleResult adjustBundle(BundleProblem& problem, const BundleSettings& settings) {
  return BundleAdjuster().adjust(problem, settings);
}

/// A vector of a motion from its six numbers.
inline Vector6d vector6(double x, double y, double z, double rx, double ry, double rz) {
  Vector6d vector;
  vector << x, y, z, rx, ry, rz;
  return vector;
}

/// A drive along a straight line with a steady turn: place and turn are linear in time, as the estimator
/// takes them to be between two pairs, so that an offset adds no error of the model.
inline Eigen::Isometry3d steadyDrive(double time) {
  return motionFromVector(time * vector6(0.1, -0.05, 2.7, 0.02, -0.3, 0.05));
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

/// Where a right camera that is off its calibration sees what one that is not would see at `pixel`.
inline Eigen::Vector2d asSeenBy(const RigCorrection& rig, const Eigen::Vector2d& pixel) {
  Eigen::Vector2d seen = pixel;
  for (int i = 0; i < 5; ++i)  // the inverse of the correction, by iteration
    seen += pixel - correctedRight(kRigCamera, rig, seen);
  return seen;
}

/// What a window of pairs sees of a static world.
struct LandmarkScene {
  int frames = 7;
  int free_frames = 1;
  int landmarks = 70;
  double offset = 0.0;        ///< s, of every pair
  double noise = 0.0;         ///< in units of what the problem assumes
  double coarse_noise = 0.0;  ///< the same of each other landmark, which is of level 1; 0: there are none
  double wrong_disparities = 0.0;  ///< share of the stereo matches that are somewhere else
  RigCorrection rig{};             ///< what the calibration is off by
  double delay = 0.0;              ///< s, by which right cameras are exposed later than `offset` says
};

/// A problem whose start is the truth.
inline BundleProblem seenBy(const LandmarkScene& scene, std::uint64_t seed) {
  Noise random(seed);
  Noise random_rows(seed + 1'000'000);
  BundleProblem problem;
  problem.camera = kRigCamera;
  problem.fixed = scene.frames - scene.free_frames;
  for (int i = 0; i < scene.frames; ++i)
    problem.poses.push_back({i * kFramePeriod, scene.offset, steadyDrive(i * kFramePeriod)});

  const auto see = [&](BundleLandmark& landmark, int frame, const Eigen::Vector3d& world) {
    const bool is_host = landmark.sightings.empty();
    const TimedPose& pose = problem.poses[frame];
    const Eigen::Vector3d in_left = pose.T_world_camera.inverse() * world;
    const Eigen::Vector3d in_right =
        rightOf(steadyDrive(pose.time + pose.offset + scene.delay)).inverse() * world;
    if (in_left.z() < 0.5 || in_right.z() < 0.5 || !inView(project(kRigCamera, in_left))) return;
    const Eigen::Vector2d left = project(kRigCamera, in_left);
    const Eigen::Vector2d right = asSeenBy(scene.rig, project(kRigCamera, in_right));
    const double disparity = left.x() - right.x();
    const BundleNoise& assumed = problem.noise[landmark.level];
    const double deviation = assumed.disparity + assumed.stretch * std::abs(disparity);
    const double noise = landmark.level > 0 ? scene.coarse_noise : scene.noise;

    BundleSighting sighting;
    sighting.pose = frame;
    sighting.left = left;
    if (!is_host)  // there, the position defines the landmark
      for (int axis = 0; axis < 2; ++axis)
        sighting.left[axis] += noise * assumed.pixel * random.gaussian();
    double measured = disparity + noise * deviation * random.gaussian();
    if (random.uniform() < scene.wrong_disparities) measured += 5.0 + 30.0 * random.uniform();
    sighting.stereo = true;
    const double rows = left.y() - right.y() + noise * assumed.pixel * random_rows.gaussian();
    sighting.right = sighting.left - Eigen::Vector2d(measured, rows);
    landmark.sightings.push_back(sighting);
  };

  for (int i = 0; i < scene.landmarks; ++i) {
    const int host = i % (scene.frames - 1);
    BundleLandmark landmark;
    if (scene.coarse_noise > 0.0) landmark.level = i % 2;
    const double column = kRigCamera.width * random.uniform();
    const double row = kRigCamera.height * random.uniform();
    landmark.bearing = bearingOf(kRigCamera, {column, row});
    landmark.inverse_depth = 1.0 / 30.0 + 0.3 * random.uniform();
    const Eigen::Vector3d world =
        problem.poses[host].T_world_camera * (landmark.bearing / landmark.inverse_depth);
    for (int frame = host; frame < scene.frames; ++frame)
      see(landmark, frame, world);
    if (landmark.sightings.size() > 1) problem.landmarks.push_back(landmark);
  }
  return problem;
}

/// Moves the start off the truth: by a size of 1, as far as a search may leave it.
inline void disturb(BundleProblem& problem, double size = 1.0) {
  for (std::size_t i = static_cast<std::size_t>(problem.fixed); i < problem.poses.size(); ++i) {
    Eigen::Isometry3d& pose = problem.poses[i].T_world_camera;
    pose = pose * motionFromVector(size * vector6(0.01, -0.01, 0.02, 0.002, -0.003, 0.002));
  }
  for (std::size_t i = 0; i < problem.landmarks.size(); ++i)
    problem.landmarks[i].inverse_depth *= 1.0 + size * (i % 2 == 0 ? 0.1 : -0.08);
}

/// Errors of the free poses, perturbations on the right, oldest first, given that the drive was the steady
/// one.
inline Eigen::VectorXd poseErrors(const BundleProblem& problem) {
  const int free = static_cast<int>(problem.poses.size()) - problem.fixed;
  Eigen::VectorXd errors(6 * free);
  for (int i = 0; i < free; ++i) {
    const TimedPose& pose = problem.poses[problem.fixed + i];
    errors.segment<6>(6 * i) = vectorFromMotion(steadyDrive(pose.time).inverse() * pose.T_world_camera);
  }
  return errors;
}

}  // namespace cartvo::test
