#include "calib/stereo_calibration.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "calib/calibration_start.hpp"

namespace cartvo {
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
                                           LensModel lens, double deviation) {
  const Eigen::MatrixXd covariance = deviation * deviation *
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

std::string twoDigits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", value);
  return text;
}

BoardView withinReach(const BoardView& view, const ViewResiduals& residuals, double reach) {
  const auto within = [&](const std::vector<SeenCorner>& seen, const std::vector<Eigen::Vector2d>& off) {
    std::vector<SeenCorner> kept;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (off[i].norm() <= reach) kept.push_back(seen[i]);
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
  constexpr int kMostRounds = 6;
  constexpr double kHuber = 2.5;            // deviations
  constexpr double kLeastDeviation = 1e-4;  // px; so that noise-free corners have a scale too
  constexpr double kSettled = 0.01;
  const std::vector<int> free = freeRigParameters(model);
  BoardAdjustment adjusted;
  adjusted.estimate = start;
  double deviation = std::max(robustDeviation(residualsOf(start, views, board_corners)), kLeastDeviation);
  for (int round = 0; round < kMostRounds; ++round) {
    adjusted = adjustBoards(adjusted.estimate, views, board_corners,
                            {free, kHuber * deviation, deviation * deviation});
    if (!std::isfinite(adjusted.cost)) {
      throw std::runtime_error("model " + modelName(model) +
                               " cannot show what is seen: boards stand beside or behind the camera for it");
    }
    const double before = deviation;
    deviation =
        std::max(robustDeviation(residualsOf(adjusted.estimate, views, board_corners)), kLeastDeviation);
    if (std::abs(before - deviation) < kSettled * before) break;
  }
  return {model, adjusted.estimate, deviation, estimatesOf(adjusted, free, lensOf(model), deviation)};
}

std::vector<StereoCalibration> calibrateStereo(const std::vector<BoardView>& views,
                                               const std::vector<Eigen::Vector2d>& board_corners,
                                               cv::Size image_size,
                                               const std::vector<CalibrationModel>& models) {
  const LensModel lens = lensOf(models.front());
  RigAndBoards start = calibrationStart(views, board_corners, image_size, lens);
  std::vector<StereoCalibration> calibrations;
  for (const CalibrationModel model : models) {
    calibrations.push_back(calibrateStereoFrom(start, views, board_corners, model));
    start = calibrations.back().estimate;
  }
  return calibrations;
}

CleanedViews withoutOutliers(const StereoCalibration& calibration, const std::vector<BoardView>& views,
                             const std::vector<Eigen::Vector2d>& board_corners) {
  constexpr double kCornerReach = 5.0;  // deviations; normal scatter passes it once in 300,000 corners
  constexpr double kViewReach = 3.0;    // of the median view's
  constexpr double kLeastShare = 0.7;   // of a view's corners
  const std::vector<ViewResiduals> residuals = residualsOf(calibration.estimate, views, board_corners);
  std::vector<double> rms;
  for (const ViewResiduals& view : residuals)
    rms.push_back(residualRms(view));
  std::vector<double> sorted = rms;
  std::sort(sorted.begin(), sorted.end());
  const double median = sorted.empty() ? 0.0 : sorted[sorted.size() / 2];

  CleanedViews cleaned;
  for (std::size_t i = 0; i < views.size(); ++i) {
    BoardView kept = withinReach(views[i], residuals[i], kCornerReach * calibration.corner_deviation);
    const double share = static_cast<double>(cornersOf(kept)) /
                         static_cast<double>(std::max<std::size_t>(cornersOf(views[i]), 1));
    if (share < kLeastShare && rms[i] > kViewReach * median) {
      cleaned.rejected.push_back({views[i].name, "its corners lie " + twoDigits(rms[i]) +
                                                     " px off where the other views put them (the median "
                                                     "view's " +
                                                     twoDigits(median) +
                                                     " px): did the board move, or bend?"});
      continue;
    }
    cleaned.rejected_corners += cornersOf(views[i]) - cornersOf(kept);
    cleaned.views.push_back(std::move(kept));
  }
  return cleaned;
}

}  // namespace cartvo
