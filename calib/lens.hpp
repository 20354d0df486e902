#pragma once

#include <Eigen/Core>
#include <variant>

#include "calib/brown_distortion.hpp"
#include "calib/normalised_point.hpp"
#include "calib/rig.hpp"
#include "calib/wide_distortion.hpp"

namespace cartvo {

/// The lens of a camera, of whichever model: what rays become on the image plane at distance 1, before focal
/// length and principal point. The same bits on each machine.
class Lens {
 public:
  explicit Lens(const CameraModel& camera);

  /// Where a ray (camera axes, any length) is seen. Rays the lens does not see are taken back to its rim.
  NormalisedPoint distort(const Eigen::Vector3d& ray) const;

  /// A ray (camera axes, any length) that is seen at `distorted`. Throws std::invalid_argument if Brown's
  /// distortion folds before it reaches this far; a wide lens gives a ray at its rim.
  Eigen::Vector3d undistort(NormalisedPoint distorted) const;

 private:
  std::variant<BrownDistortion, WideDistortion> distortion_;
};

}  // namespace cartvo
