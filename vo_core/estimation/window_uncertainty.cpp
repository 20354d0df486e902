// Covariances of adjusted poses: noise, drift, scale and the common error of the time offset.
#include "vo_core/estimation/window_uncertainty.hpp"

#include "vo_core/image/affine_alignment.hpp"

namespace cartvo::vo {
namespace {

/// Motion from the last but one to the last pair.
Eigen::Isometry3d lastMotion(const std::vector<WindowFrame>& window) {
  return window[window.size() - 2].T_world_camera.inverse() * window.back().T_world_camera;
}

/// Mean motion in the left image, in halves of a patch, of the landmarks observed by both the last but one
/// and the last pose.
double patchMotion(const BundleProblem& problem) {
  const int last = static_cast<int>(problem.poses.size()) - 1;
  double sum = 0.0;
  int count = 0;
  for (const BundleLandmark& landmark : problem.landmarks) {
    const auto& observations = landmark.observations;
    if (observations.size() < 2 || observations.back().pose != last) continue;
    const BundleObservation& before = *(observations.end() - 2);
    if (before.pose != last - 1) continue;
    sum += (observations.back().left - before.left).norm();
    ++count;
  }
  return count > 0 ? sum / (0.5 * kPatchSide * count) : 0.0;
}

/// Updates the poses' covariances; returns the motion's covariance due to the landmarks.
Matrix6d updateCovariances(const BundleProblem& problem, const BundleResult& result,
                           const PairInflation& inflation, const UncertaintySettings& settings,
                           std::vector<WindowFrame>& window) {
  const auto block = [&](std::size_t a, std::size_t b) -> Matrix6d {
    if (static_cast<int>(a) < problem.fixed || static_cast<int>(b) < problem.fixed) return Matrix6d::Zero();
    const auto at = [&](std::size_t i) { return 6 * (static_cast<Eigen::Index>(i) - problem.fixed); };
    return result.covariance.block<6, 6>(at(a), at(b));
  };
  const std::size_t last = window.size() - 1;
  const double patch_motion = patchMotion(problem);
  const std::size_t last_fixed = static_cast<std::size_t>(problem.fixed) - 1;
  const WindowFrame& reference = window[last_fixed];
  for (std::size_t i = last_fixed + 1; i <= last; ++i) {
    window[i].local_covariance = block(i, i);
    window[i].uncertainty =
        afterMotion(reference.uncertainty, reference.T_world_camera.inverse() * window[i].T_world_camera,
                    {static_cast<int>(i - last_fixed),
                     inflation.overlap * inflation.pose_noise_inflation * block(i, i), patch_motion},
                    settings);
  }
  // The motion has the errors of both poses relative to the landmarks minus their correlation.
  const Matrix6d carried = adjoint(lastMotion(window).inverse());
  return settings.motion_noise_factor * inflation.overlap *
         (window[last].local_covariance + carried * window[last - 1].local_covariance * carried.transpose() -
          carried * block(last - 1, last) - block(last, last - 1) * carried.transpose());
}

/// Covariance of the last motion due to the variance of the scale factor.
Matrix6d scaledCovariance(const std::vector<WindowFrame>& window, double scale_variance) {
  const Eigen::Isometry3d motion = lastMotion(window);
  Vector6d by_scale = Vector6d::Zero();
  by_scale.head<3>() = motion.linear().transpose() * motion.translation();
  return scale_variance * by_scale * by_scale.transpose();
}

/// Updates the poses' errors due to the time offset; returns the motion's. The offset error is constant for
/// an unknown time, so it accumulates in a pose with its sign. The same errors are also added as independent
/// ones, so that they do not cancel when the cart turns left and right.
Vector6d updateOffsetErrors(const BundleProblem& problem, double offset_stddev,
                            std::vector<WindowFrame>& window) {
  const std::size_t reference = static_cast<std::size_t>(problem.fixed) - 1;
  const std::size_t last = window.size() - 1;
  const auto error_of_way = [&](std::size_t from, std::size_t to) -> Vector6d {
    const Eigen::Isometry3d way = window[from].T_world_camera.inverse() * window[to].T_world_camera;
    return offset_stddev * (window[to].dpose_doffset - adjoint(way.inverse()) * window[from].dpose_doffset);
  };
  for (std::size_t i = reference + 1; i <= last; ++i) {
    window[i].dpose_doffset = problem.poses[i].dpose_doffset;
    const Eigen::Isometry3d way = window[reference].T_world_camera.inverse() * window[i].T_world_camera;
    const Vector6d error = error_of_way(reference, i);
    window[i].offset_error = adjoint(way.inverse()) * window[reference].offset_error + error;
    window[i].uncertainty.pose += error * error.transpose();
  }
  return error_of_way(last - 1, last);
}

}  // namespace

MotionError updateUncertainties(const BundleProblem& problem, const BundleResult& result,
                                const PairInflation& inflation, const UncertaintySettings& settings,
                                std::vector<WindowFrame>& window) {
  MotionError motion;
  motion.by_landmarks = updateCovariances(problem, result, inflation, settings, window);
  motion.by_scale = scaledCovariance(window, result.scale_variance);
  motion.codec_inflation = inflation.pose_noise_inflation;
  motion.by_offset = updateOffsetErrors(problem, inflation.offset_stddev, window);
  return motion;
}

Matrix6d poseCovarianceOf(const WindowFrame& frame) {
  return frame.uncertainty.pose + frame.offset_error * frame.offset_error.transpose();
}

}  // namespace cartvo::vo
