#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/board_spec.hpp"
#include "calib/calibration_difference.hpp"
#include "calib/cross_validation.hpp"
#include "calib/stereo_calibration.hpp"
#include "calib/sync_fault.hpp"
#include "calib/view_coverage.hpp"

namespace cartvo {

/// A model that was tried.
struct CandidateModel {
  CalibrationModel model = CalibrationModel::brown5;
  std::optional<StereoCalibration> calibration;  ///< none if the model cannot describe the views
  std::optional<CrossValidation> validation;     ///< none if it could not be solved without some of them
  std::string refusal;                           ///< why it cannot be chosen; empty if it can
};

/// Something a calibration must fulfil.
struct ValidationCheck {
  std::string name;
  double value = 0.0, limit = 0.0;  ///< in `unit`
  std::string unit;
  bool passed = false;
};

/// All that a calibration from views tells.
struct Calibration {
  BoardSpec board;
  cv::Size image_size;
  std::vector<BoardView> views;  ///< those used, without the corners that were rejected
  std::vector<RejectedView> rejected;
  std::size_t rejected_corners = 0;
  std::vector<CandidateModel> candidates;
  std::size_t chosen = 0;                ///< which candidate
  std::vector<ViewResiduals> residuals;  ///< of the chosen, view by view
  CalibrationDifference halves;          ///< between calibrations from every other view
  SyncDiagnosis sync;
  ImageCoverage left_coverage, right_coverage;
  TiltCoverage tilts;
  std::vector<ValidationCheck> checks;

  const StereoCalibration& result() const { return *candidates[chosen].calibration; }
  const CrossValidation& validation() const { return *candidates[chosen].validation; }
  const Rig& rig() const { return result().estimate.rig; }

  /// Whether all checks are passed.
  bool passed() const;
};

/// The distances for which depth errors are told, m.
inline const std::vector<double> kDepthDistances{5.0, 10.0, 20.0, 40.0};

/// The depth error at a distance (m) that an error of disparity (px of rectified images with this focal
/// length) causes: Z^2 / (f b) to first order.
double depthError(double distance, double disparity_error, double focal_length, double baseline);

/// Standard deviation of the rig's scale, as a share: what the corners' scatter says of the baseline, or half
/// of what the halves' baselines differ by if that is more, and a thousandth, as nobody knows the board's
/// squares better.
double scaleDeviation(const Calibration& calibration);

/// Calibrates with each of the models (of a lens from few parameters to many), and chooses the one that
/// foretells held-out views best; of models that do so within 1 %, the one with the fewest parameters.
/// Outliers are told by the model with the least scatter, and all models are then judged on the same corners.
/// Throws std::runtime_error saying what is wrong with the views: too few, all tilted alike, left and right
/// exchanged, or no model can describe them.
Calibration calibrateViews(const std::vector<BoardView>& views, const BoardSpec& board, cv::Size image_size,
                           const std::vector<CalibrationModel>& models);

}  // namespace cartvo
