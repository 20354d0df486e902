#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "vo_core/geometry/exposure_motion.hpp"
#include "vo_core/shutter.hpp"
#include "vo_core/stereo_camera.hpp"
#include "vo_core/tracking/landmark.hpp"
#include "vo_core/tracking/window_frame.hpp"

// Rolling shutters: the instants of pixels, and the positions that they would have if all rows were exposed
// with the middle one.

namespace cartvo::vo {

/// Instants of the pixels of both cameras relative to the exposure of their own image.
class RowTiming {
 public:
  RowTiming(const StereoCamera& camera, const StereoShutters& shutters)
      : camera_(camera), shutters_(shutters), may_roll_(shutters.areRolling()) {}

  /// Whether pixels are taken to be exposed at different instants.
  bool isRolling() const { return shutters_.left.readout != 0.0 || shutters_.right.readout != 0.0; }
  /// Whether they may be: not with global shutters that are known.
  bool mayRoll() const { return may_roll_; }
  double left(const Eigen::Vector2d& pixel) const { return instant(shutters_.left, pixel); }    ///< s
  double right(const Eigen::Vector2d& pixel) const { return instant(shutters_.right, pixel); }  ///< s
  double leftShare(const Eigen::Vector2d& pixel) const {
    return shutters_.left.rows.at(pixel, camera_.height);
  }
  double rightShare(const Eigen::Vector2d& pixel) const {
    return shutters_.right.rows.at(pixel, camera_.height);
  }
  const StereoShutters& shutters() const { return shutters_; }

  /// Times rows with these readouts.
  void use(const ReadoutEstimates& readouts) {
    shutters_.left.readout = readouts.left.value;
    shutters_.right.readout = readouts.right.value;
  }

  /// Half of the longer readout, s, at least a millisecond.
  double range() const;

 private:
  double instant(const Shutter& shutter, const Eigen::Vector2d& pixel) const {
    return shutter.readout * shutter.rows.at(pixel, camera_.height);
  }

  StereoCamera camera_;
  StereoShutters shutters_;
  bool may_roll_ = false;
};

/// Transform of points from the left camera at the instant of a left pixel to the right camera at the instant
/// of the same row.
class RowTransform {
 public:
  /// The same for all rows: global shutters.
  explicit RowTransform(const Eigen::Isometry3d& T_right_left) : T_right_left_(T_right_left) {}

  /// `T_right_left`: between the exposures of both images, with the rig's correction. `frame`: the pair.
  /// Keeps a reference to `timing`.
  RowTransform(const StereoCamera& camera, const RowTiming& timing, const WindowFrame& frame,
               const Eigen::Isometry3d& T_right_left);

  Eigen::Isometry3d at(const Eigen::Vector2d& left_pixel) const;
  /// The left camera at the instant of a pixel, relative to its exposure.
  Eigen::Isometry3d exposureFromLeft(const Eigen::Vector2d& left_pixel) const;

 private:
  const RowTiming* timing_ = nullptr;  ///< null if all rows move alike
  Eigen::Isometry3d T_right_left_;
  ExposureMotion left_, right_;
};

/// Recomputes the row shifts of the landmarks' observations by the pairs window[first] and later, from their
/// depths, the poses and motions of the window. `predicted_inverse_depth`: 1/m,
/// of points without a depth.
void correctRows(const StereoCamera& camera, const RowTiming& timing, const std::vector<WindowFrame>& window,
                 std::size_t first, double predicted_inverse_depth, std::vector<Landmark>& landmarks);

}  // namespace cartvo::vo
