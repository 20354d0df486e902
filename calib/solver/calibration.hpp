#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/board/board_spec.hpp"
#include "calib/board/view_coverage.hpp"
#include "calib/solver/cross_validation.hpp"
#include "calib/solver/stereo_calibration.hpp"

// Calibration from views: choice of the lens model, outlier rejection and validation.

namespace cartvo::calib {

/// A calibration model with its result.
struct CandidateModel {
  CalibrationModel model = CalibrationModel::brown5;
  std::optional<StereoCalibration> calibration;  ///< std::nullopt if the model cannot be fitted to the views
  std::optional<CrossValidation> validation;  ///< std::nullopt if it cannot be fitted to a part of the views
  std::string refusal;                        ///< why the model cannot be chosen; empty if it can
};

/// A requirement on a calibration, and whether it is met.
struct ValidationCheck {
  std::string name;
  double value = 0.0, limit = 0.0;  ///< in `unit`
  std::string unit;
  bool passed = false;
};

/// Result of a calibration from views.
struct Calibration {
  BoardSpec board;
  cv::Size image_size;
  std::vector<BoardView> views;  ///< the views used, without rejected corners
  std::vector<RejectedView> rejected;
  std::size_t rejected_corners = 0;
  std::vector<CandidateModel> candidates;
  std::size_t chosen = 0;                ///< index in `candidates`
  std::vector<ViewResiduals> residuals;  ///< of the chosen candidate, one per view
  CalibrationDifference halves;          ///< between calibrations from the even and from the odd views
  SyncDiagnosis sync;
  ImageCoverage left_coverage, right_coverage;
  TiltCoverage tilts;
  std::vector<ValidationCheck> checks;

  const StereoCalibration& result() const { return *candidates[chosen].calibration; }
  const CrossValidation& validation() const { return *candidates[chosen].validation; }
  const Rig& rig() const { return result().estimate.rig; }

  /// Whether all checks passed.
  bool passed() const;
};

/// A distance in an image as text, "0.25 px"; infinite ones (nothing to compare) become "not seen".
std::string pixelText(double pixels);

/// Reservations about a calibration that passes, one sentence each, with what to add: too few views, parts
/// of the images without corners, and two halves of the views that disagree about pixels or depths. Empty if
/// nothing.
std::vector<std::string> reservationsOf(const Calibration& calibration);

/// Distances at which depth errors are reported, m.
inline const std::vector<double> kDepthDistances{5.0, 10.0, 20.0, 40.0};

/// The depth error (m) at a distance (m) that is caused by a disparity error (px of rectified images with
/// this focal length): to first order Z^2 / (f b) times the disparity error.
double depthError(double distance, double disparity_error, double focal_length, double baseline);

/// Relative standard deviation of the rig's scale: that of the baseline from the corners' noise, or half the
/// difference of the two halves' baselines if that is larger, combined with 0.001 for the measurement of the
/// board's squares. At most 0.05.
double scaleStddev(const Calibration& calibration);

/// Calibrates with each of the models (ordered by their number of parameters for each lens) and chooses the
/// one with the smallest error on held-out views; among models within 1 % of it, the one with the fewest
/// parameters. Outliers are identified with the model that has the smallest corner noise, and all models are
/// then compared on the same corners. Throws std::runtime_error with the fault of the views: too few, all
/// with the same tilt, left and right exchanged, or described by no model.
Calibration calibrateViews(const std::vector<BoardView>& views, const BoardSpec& board, cv::Size image_size,
                           const std::vector<CalibrationModel>& models);

}  // namespace cartvo::calib
