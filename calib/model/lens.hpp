#pragma once

#include <Eigen/Core>
#include <variant>

#include "calib/model/brown_distortion.hpp"
#include "calib/model/normalised_point.hpp"
#include "calib/model/rig.hpp"
#include "calib/model/wide_distortion.hpp"

namespace cartvo::calib {

/// The distortion of a camera's lens, of either model: rays to distorted normalised coordinates (before focal
/// length and principal point) and back. Results are bit-identical on every machine.
class Lens {
 public:
  explicit Lens(const CameraModel& camera);

  /// The distorted position of a ray (camera axes, any length). A ray outside the lens' field of view is
  /// moved to its rim.
  NormalisedPoint distort(const Eigen::Vector3d& ray) const;

  /// The ray (camera axes, any length) of a distorted position. Beyond the field of view, Brown's model
  /// throws std::invalid_argument, and a wide lens returns the ray at its rim.
  Eigen::Vector3d undistort(NormalisedPoint distorted) const;

 private:
  std::variant<BrownDistortion, WideDistortion> distortion_;
};

}  // namespace cartvo::calib
