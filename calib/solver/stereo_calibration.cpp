// Calibration of a stereo rig under one model, and rejection of outliers.
#include "calib/solver/stereo_calibration.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "calib/solver/initial_calibration.hpp"
#include "common/exact_text.hpp"

namespace cartvo::calib {
namespace {

std::vector<ViewResiduals> residualsOf(const RigAndBoards& estimate, const std::vector<BoardView>& views,
                                       const std::vector<Eigen::Vector2d>& board_corners) {
  std::vector<ViewResiduals> residuals;
  for (std::size_t i = 0; i < views.size(); ++i)
    residuals.push_back(viewResiduals(estimate.rig, estimate.T_left_board[i], views[i], board_corners));
  return residuals;
}

double valueOf(const Rig& rig, int parameter) {
  if (parameter >= kRelativeTranslation)
    return rig.T_right_left.translation()[parameter - kRelativeTranslation];
  if (parameter >= kRelativeRotation) {
    const Eigen::AngleAxisd rotation(rig.T_right_left.linear());
    return rotation.angle() * rotation.axis()[parameter - kRelativeRotation];
  }
  if (parameter >= kRightCamera) return parametersOf(rig.right)[parameter - kRightCamera];
  return parametersOf(rig.left)[parameter];
}

std::vector<ParameterEstimate> estimatesOf(const BoardAdjustment& adjustment, const std::vector<int>& free,
                                           LensModel lens, double corner_stddev) {
  const Eigen::MatrixXd covariance = corner_stddev * corner_stddev *
                                     adjustment.information.ldlt().solve(Eigen::MatrixXd::Identity(
                                         adjustment.information.rows(), adjustment.information.cols()));
  std::vector<ParameterEstimate> estimates;
  for (std::size_t i = 0; i < free.size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    estimates.push_back({parameterName(free[i], lens), valueOf(adjustment.estimate.rig, free[i]),
                         std::sqrt(std::max(covariance(index, index), 0.0))});
  }
  return estimates;
}

/// The view without the corners whose residuals exceed the gate (px).
BoardView withinGate(const BoardView& view, const ViewResiduals& residuals, double gate) {
  const auto within = [&](const std::vector<SeenCorner>& seen, const std::vector<Eigen::Vector2d>& errors) {
    std::vector<SeenCorner> kept;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (errors[i].norm() <= gate) kept.push_back(seen[i]);
    }
    return kept;
  };
  return {view.name, within(view.left, residuals.left), within(view.right, residuals.right)};
}

std::size_t cornersOf(const BoardView& view) {
  return view.left.size() + view.right.size();
}

}  // namespace

double residualRms(const ViewResiduals& residuals) {
  double squares = 0.0;
  for (const auto* side : {&residuals.left, &residuals.right}) {
    for (const Eigen::Vector2d& residual : *side)
      squares += residual.squaredNorm();
  }
  const std::size_t count = residuals.left.size() + residuals.right.size();
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(count, 1)));
}

StereoCalibration calibrateStereoFrom(const RigAndBoards& start, const std::vector<BoardView>& views,
                                      const std::vector<Eigen::Vector2d>& board_corners,
                                      CalibrationModel model) {
  constexpr int kMaxRounds = 6;
  constexpr double kHuber = 2.5;               // standard deviations
  constexpr double kMinStddev = 1e-4;          // px; so that noise-free corners have a scale too
  constexpr double kMaxRelativeChange = 0.01;  // of the standard deviation, to stop
  const std::vector<int> free = freeRigParameters(model);
  BoardAdjustment adjusted;
  adjusted.estimate = start;
  double stddev = std::max(robustStddev(residualsOf(start, views, board_corners)), kMinStddev);
  for (int round = 0; round < kMaxRounds; ++round) {
    adjusted =
        adjustBoards(adjusted.estimate, views, board_corners, {free, kHuber * stddev, stddev * stddev});
    if (!std::isfinite(adjusted.cost)) {
      throw std::runtime_error("model " + modelName(model) +
                               " cannot be fitted: it puts boards beside or behind the camera");
    }
    const double before = stddev;
    stddev = std::max(robustStddev(residualsOf(adjusted.estimate, views, board_corners)), kMinStddev);
    if (std::abs(before - stddev) < kMaxRelativeChange * before) break;
  }
  return {model, adjusted.estimate, stddev, estimatesOf(adjusted, free, lensOf(model), stddev)};
}

std::vector<StereoCalibration> calibrateStereo(const std::vector<BoardView>& views,
                                               const std::vector<Eigen::Vector2d>& board_corners,
                                               cv::Size image_size,
                                               const std::vector<CalibrationModel>& models) {
  const LensModel lens = lensOf(models.front());
  RigAndBoards start = initialCalibration(views, board_corners, image_size, lens);
  std::vector<StereoCalibration> calibrations;
  for (const CalibrationModel model : models) {
    calibrations.push_back(calibrateStereoFrom(start, views, board_corners, model));
    start = calibrations.back().estimate;
  }
  return calibrations;
}

CleanedViews rejectOutliers(const StereoCalibration& calibration, const std::vector<BoardView>& views,
                            const std::vector<Eigen::Vector2d>& board_corners) {
  constexpr double kCornerGate = 5.0;  // standard deviations; normal noise exceeds it once in 300,000 corners
  constexpr double kViewGate = 3.0;    // of the RMS of the median view
  constexpr double kMinShare = 0.7;    // of a view's corners
  const std::vector<ViewResiduals> residuals = residualsOf(calibration.estimate, views, board_corners);
  std::vector<double> rms;
  for (const ViewResiduals& view : residuals)
    rms.push_back(residualRms(view));
  std::vector<double> sorted = rms;
  std::sort(sorted.begin(), sorted.end());
  const double median = sorted.empty() ? 0.0 : sorted[sorted.size() / 2];

  CleanedViews cleaned;
  for (std::size_t i = 0; i < views.size(); ++i) {
    BoardView kept = withinGate(views[i], residuals[i], kCornerGate * calibration.corner_stddev);
    const double share = static_cast<double>(cornersOf(kept)) /
                         static_cast<double>(std::max<std::size_t>(cornersOf(views[i]), 1));
    if (share < kMinShare && rms[i] > kViewGate * median) {
      cleaned.rejected.push_back({views[i].name, "the RMS error of its corners is " + fixedText(rms[i], 2) +
                                                     " px (median of all views: " + fixedText(median, 2) +
                                                     " px): did the board move, or is it not flat?"});
      continue;
    }
    cleaned.rejected_corners += cornersOf(views[i]) - cornersOf(kept);
    cleaned.views.push_back(std::move(kept));
  }
  return cleaned;
}

}  // namespace cartvo::calib
