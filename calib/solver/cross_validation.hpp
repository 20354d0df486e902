#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/board/board_view.hpp"
#include "calib/board/view_coverage.hpp"
#include "calib/model/lens.hpp"
#include "calib/model/rig.hpp"
#include "calib/rectification/rectification.hpp"
#include "calib/solver/board_adjustment.hpp"
#include "calib/solver/stereo_calibration.hpp"

// Cross-validation of a calibration on held-out views.
// Comparison of two calibrations of the same rig.

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

/// Errors of a view under a calibration from the other views.
struct HeldOutView {
  double rms = 0.0;                          ///< reprojection error, px
  std::vector<double> vertical_disparities;  ///< px of the rectified images
};

/// Errors of a model on views that were held out.
struct CrossValidation {
  std::vector<HeldOutView> views;       ///< in the order of the calibration's views
  double rms = 0.0;                     ///< over all corners, px
  double vertical_disparity_rms = 0.0;  ///< px of the rectified images
  double vertical_disparity_p95 = 0.0;  ///< 95th percentile of the absolute value, px
};

/// Cross-validates a calibration: holds out each of `folds` parts of the views in turn, calibrates with the
/// others, and evaluates the held-out views, to which only the board's pose is fitted. Throws
/// std::runtime_error if the model cannot be fitted to a part of the views.
CrossValidation crossValidate(const StereoCalibration& calibration, const std::vector<BoardView>& views,
                              const std::vector<Eigen::Vector2d>& board_corners, int folds);

/// Views in which the board moved between the exposures of the two cameras.
struct SyncDiagnosis {
  int opposed_views = 0;   ///< views whose mean left and right residuals point in opposite directions
  double max_shift = 0.0;  ///< largest difference of these means, px
  bool is_fault = false;   ///< whether there are too many of them to trust the calibration
};

/// Detects views of a moving board. Its adjusted pose is between its poses at the two exposures, so all left
/// corners have about the same residual and all right ones the opposite. A wrong rig does not cause this,
/// since the relative pose absorbs what is common to all views. `corner_stddev`: noise of the corners, px.
SyncDiagnosis diagnoseSync(const std::vector<ViewResiduals>& residuals, double corner_stddev);

/// Difference in depth between two calibrations at one distance. Infinite if no point at this distance is
/// visible in covered cells of both images.
struct DepthDifference {
  double distance = 0.0;  ///< m
  double median = 0.0;    ///< of the difference over the image, m
  double p95 = 0.0;       ///< 95th percentile, m
};

/// Difference between two calibrations of the same rig. Infinite if there is no place to compare them.
struct CalibrationDifference {
  double projection_rms = 0.0;  ///< over both images, after rotating the cameras for the best agreement, px
  double projection_p95 = 0.0;  ///< 95th percentile, px
  double baseline = 0.0;        ///< relative difference of the baselines
  std::vector<DepthDifference> depth;
};

/// Compares two calibrations on a grid of the images, in covered cells and up to 60 degrees from the axis.
/// Projection: the distance between the pixels of the same ray, after the rotation of the camera that a
/// calibration cannot determine (as in mrcal; D. Kogan, "Improved camera calibration with mrcal"). Depth:
/// that which `b` triangulates for points that `a` puts at these distances (m) from the left camera.
CalibrationDifference compareCalibrations(const Rig& a, const Rig& b, const ImageCoverage& left,
                                          const ImageCoverage& right, const std::vector<double>& distances);

}  // namespace cartvo::calib
