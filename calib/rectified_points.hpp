#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/board_view.hpp"
#include "calib/lens.hpp"
#include "calib/rectification.hpp"
#include "calib/rig.hpp"

namespace cartvo {

/// Where raw pixels lie in rectified images that are as fine in their middle as the raw ones: the focal
/// length is the mean of the cameras', so that pixels mean the same whatever is cropped.
class RectifiedPoints {
 public:
  /// Throws std::invalid_argument if the cameras do not stand side by side, see rectifyingRotations.
  explicit RectifiedPoints(const Rig& rig);

  /// px.
  double focalLength() const { return focal_length_; }

  /// From the rectified camera's axis, px; nothing for what lies beside or behind it.
  std::optional<Eigen::Vector2d> ofLeft(const Eigen::Vector2d& raw_pixel) const {
    return rectified(left_, left_lens_, rotations_.left, raw_pixel);
  }
  std::optional<Eigen::Vector2d> ofRight(const Eigen::Vector2d& raw_pixel) const {
    return rectified(right_, right_lens_, rotations_.right, raw_pixel);
  }

 private:
  std::optional<Eigen::Vector2d> rectified(const CameraModel& camera, const Lens& lens,
                                           const Eigen::Matrix3d& rotation,
                                           const Eigen::Vector2d& raw_pixel) const;

  CameraModel left_, right_;
  Lens left_lens_, right_lens_;
  RectifyingRotations rotations_;
  double focal_length_;
};

/// Left minus right row of each corner that both cameras see, px of the rectified images: zero but for the
/// corners' scatter if the calibration is right.
std::vector<double> verticalDisparities(const RectifiedPoints& rectified, const BoardView& view);

}  // namespace cartvo
