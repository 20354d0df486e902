// What adjusted poses err by: each for itself, and all of them by one wrong offset.
#include "vo_core/window_uncertainty.hpp"

namespace cartvo {
namespace {

// A motion errs less than the sum of its two poses' errors: both are found by comparing with the same hosts,
// whose noise they share. Found on rendered worlds (docs/accuracy.md).
constexpr double kMotionShare = 0.56;

/// From the last pair but one to the last.
Eigen::Isometry3d lastMotion(const std::vector<WindowFrame>& window) {
  return window[window.size() - 2].T_world_camera.inverse() * window.back().T_world_camera;
}

/// px that the landmarks, which both of them see, have moved in the left image from the last pose but one to
/// the last; the mean.
double imageMotion(const BundleProblem& problem) {
  const int last = static_cast<int>(problem.poses.size()) - 1;
  double sum = 0.0;
  int count = 0;
  for (const BundleLandmark& landmark : problem.landmarks) {
    const auto& sightings = landmark.sightings;
    if (sightings.size() < 2 || sightings.back().pose != last) continue;
    const BundleSighting& before = *(sightings.end() - 2);
    if (before.pose != last - 1) continue;
    sum += (sightings.back().left - before.left).norm();
    ++count;
  }
  return count > 0 ? sum / count : 0.0;
}

/// Returns the motion's covariance by its landmarks.
Matrix6d takeCovariances(const BundleProblem& problem, const BundleResult& result, const PairDoubts& doubts,
                         std::vector<WindowFrame>& window) {
  const auto block = [&](std::size_t a, std::size_t b) -> Matrix6d {
    if (static_cast<int>(a) < problem.fixed || static_cast<int>(b) < problem.fixed) return Matrix6d::Zero();
    const auto at = [&](std::size_t i) { return 6 * (static_cast<Eigen::Index>(i) - problem.fixed); };
    return result.covariance.block<6, 6>(at(a), at(b));
  };
  const std::size_t last = window.size() - 1;
  const double image_motion = imageMotion(problem);
  const std::size_t standing = static_cast<std::size_t>(problem.fixed) - 1;
  const WindowFrame& anchor = window[standing];
  for (std::size_t i = standing + 1; i <= last; ++i) {
    window[i].local_covariance = block(i, i);
    window[i].uncertainty = afterMotion(
        anchor.uncertainty, anchor.T_world_camera.inverse() * window[i].T_world_camera,
        {static_cast<int>(i - standing), doubts.overlap * doubts.excess * block(i, i), image_motion});
  }
  // Both poses err against the landmarks: the motion has the errors of both, but for what they share.
  const Matrix6d carried = adjoint(lastMotion(window).inverse());
  return kMotionShare * doubts.overlap *
         (window[last].local_covariance + carried * window[last - 1].local_covariance * carried.transpose() -
          carried * block(last - 1, last) - block(last, last - 1) * carried.transpose());
}

/// What a wrong scale, of that variance, does to the last motion.
Matrix6d scaledCovariance(const std::vector<WindowFrame>& window, double scale_variance) {
  const Eigen::Isometry3d motion = lastMotion(window);
  Vector6d by_scale = Vector6d::Zero();
  by_scale.head<3>() = motion.linear().transpose() * motion.translation();
  return scale_variance * by_scale * by_scale.transpose();
}

/// What the uncertainty of the offset makes of the poses; returns what it makes of the motion. It is one and
/// the same error for as long as the cameras' clocks keep it: in a pose it adds up with its sign. Nobody
/// knows for how long that is; the same errors, drawn anew for each pair, are counted as well, so that
/// turning left and right does not make them vanish.
Vector6d takeOffsetErrors(const BundleProblem& problem, double offset_deviation,
                          std::vector<WindowFrame>& window) {
  const std::size_t anchor = static_cast<std::size_t>(problem.fixed) - 1;
  const std::size_t last = window.size() - 1;
  const auto error_of_way = [&](std::size_t from, std::size_t to) -> Vector6d {
    const Eigen::Isometry3d way = window[from].T_world_camera.inverse() * window[to].T_world_camera;
    return offset_deviation *
           (window[to].by_late_right - adjoint(way.inverse()) * window[from].by_late_right);
  };
  for (std::size_t i = anchor + 1; i <= last; ++i) {
    window[i].by_late_right = problem.poses[i].by_late_right;
    const Eigen::Isometry3d way = window[anchor].T_world_camera.inverse() * window[i].T_world_camera;
    const Vector6d error = error_of_way(anchor, i);
    window[i].offset_error = adjoint(way.inverse()) * window[anchor].offset_error + error;
    window[i].uncertainty.pose += error * error.transpose();
  }
  return error_of_way(last - 1, last);
}

}  // namespace

MotionUncertainty takeUncertainties(const BundleProblem& problem, const BundleResult& result,
                                    const PairDoubts& doubts, std::vector<WindowFrame>& window) {
  MotionUncertainty motion;
  motion.by_landmarks = takeCovariances(problem, result, doubts, window);
  motion.by_scale = scaledCovariance(window, result.scale_variance);
  motion.offset_error = takeOffsetErrors(problem, doubts.offset_deviation, window);
  return motion;
}

Matrix6d poseCovarianceOf(const WindowFrame& frame) {
  return frame.uncertainty.pose + frame.offset_error * frame.offset_error.transpose();
}

}  // namespace cartvo
