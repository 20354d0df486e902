#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/board/board_view.hpp"
#include "calib/model/lens.hpp"
#include "calib/model/rig.hpp"
#include "calib/rectification/rectification.hpp"

namespace cartvo::calib {

/// Rectified coordinates of raw pixels. The focal length is the mean of the cameras', so that the resolution
/// equals that of the raw images in their middle, whatever is cropped.
class RectifiedPoints {
 public:
  /// Throws std::invalid_argument if the cameras are not side by side, see rectifyingRotations.
  explicit RectifiedPoints(const Rig& rig);

  /// The rectified position relative to the principal point, px. std::nullopt beyond 70 degrees from the
  /// axis.
  std::optional<Eigen::Vector2d> rectifyLeft(const Eigen::Vector2d& raw_pixel) const {
    return rectify(left_, left_lens_, rotations_.left, raw_pixel);
  }
  std::optional<Eigen::Vector2d> rectifyRight(const Eigen::Vector2d& raw_pixel) const {
    return rectify(right_, right_lens_, rotations_.right, raw_pixel);
  }

 private:
  std::optional<Eigen::Vector2d> rectify(const CameraModel& camera, const Lens& lens,
                                         const Eigen::Matrix3d& rotation,
                                         const Eigen::Vector2d& raw_pixel) const;

  CameraModel left_, right_;
  Lens left_lens_, right_lens_;
  RectifyingRotations rotations_;
  double focal_length_;
};

/// Left minus right row of each corner that both cameras see, px of the rectified images. With a correct
/// calibration only the corners' noise remains.
std::vector<double> verticalDisparities(const RectifiedPoints& rectified, const BoardView& view);

}  // namespace cartvo::calib
