// Calibration of a stereo rig under one model: its start, and rejection of outliers.
#include "calib/solver/stereo_calibration.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "calib/board/board_pose.hpp"
#include "common/exact_text.hpp"
#include "common/statistics.hpp"

namespace cartvo::calib {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The views with one camera's corners as the left ones, and no right ones.
std::vector<BoardView> oneCamera(const std::vector<BoardView>& views,
                                 std::vector<SeenCorner> BoardView::*side) {
  std::vector<BoardView> alone;
  for (const BoardView& view : views)
    alone.push_back({view.name, view.*side, {}});
  return alone;
}

double medianOrInfinity(const std::vector<double>& values) {
  return values.empty() ? kInfinity : medianOf(values);
}

double rmsOf(const std::vector<Eigen::Vector2d>& residuals) {
  double squares = 0.0;
  for (const Eigen::Vector2d& residual : residuals)
    squares += residual.squaredNorm();
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(residuals.size(), 1)));
}

struct CameraStart {
  CameraModel camera;
  std::vector<std::optional<Eigen::Isometry3d>> T_camera_board;
  double error = kInfinity;  ///< median RMS residual of the views, px
};

CameraStart posesUnder(const CameraModel& camera, const std::vector<BoardView>& views,
                       const std::vector<Eigen::Vector2d>& board_corners) {
  CameraStart start{camera, {}, kInfinity};
  std::vector<double> errors;
  Rig rig;
  rig.left = camera;
  for (const BoardView& view : views) {
    start.T_camera_board.push_back(boardPose(camera, view.left, board_corners));
    const auto& pose = start.T_camera_board.back();
    errors.push_back(pose ? rmsOf(viewResiduals(rig, *pose, view, board_corners).left) : kInfinity);
  }
  start.error = medianOrInfinity(errors);
  return start;
}

/// Searches the focal length, from 0.1 to 4 times the image width, that fits the corners to flat boards best.
CameraStart bestFocalLength(const std::vector<BoardView>& views,
                            const std::vector<Eigen::Vector2d>& board_corners, cv::Size image_size,
                            LensModel lens) {
  constexpr double kMinFactor = 0.1, kMaxFactor = 4.0, kRatio = 1.2;  // of the image width
  CameraStart best;
  for (double factor = kMinFactor; factor <= kMaxFactor; factor *= kRatio) {
    CameraModel camera;
    camera.size = image_size;
    camera.lens = lens;
    camera.fx = camera.fy = factor * image_size.width;
    camera.cx = (image_size.width - 1) / 2.0;
    camera.cy = (image_size.height - 1) / 2.0;
    CameraStart start = posesUnder(camera, views, board_corners);
    if (start.error < best.error) best = std::move(start);
  }
  if (!std::isfinite(best.error))
    throw std::runtime_error("no focal length fits the detected corners to a flat board");
  return best;
}

/// Adjusts one camera with two distortion coefficients; the principal point is fixed at first.
CameraStart startCamera(const std::vector<BoardView>& views,
                        const std::vector<Eigen::Vector2d>& board_corners, cv::Size image_size,
                        LensModel lens) {
  CameraStart start = bestFocalLength(views, board_corners, image_size, lens);
  RigAndBoards state;
  state.rig.left = start.camera;
  std::vector<BoardView> posed;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!start.T_camera_board[i]) continue;
    state.T_left_board.push_back(*start.T_camera_board[i]);
    posed.push_back(views[i]);
  }
  double scale = 2.0 * start.error;
  for (const std::vector<int>& free : {std::vector{0, 1, 4, 5}, std::vector{0, 1, 2, 3, 4, 5}}) {
    const BoardAdjustment adjusted = adjustBoards(state, posed, board_corners, {free, scale, 0.0});
    if (!std::isfinite(adjusted.cost)) break;  // poses behind the camera: keep the estimate so far
    state = adjusted.estimate;
    std::vector<ViewResiduals> residuals;
    for (std::size_t i = 0; i < posed.size(); ++i)
      residuals.push_back(viewResiduals(state.rig, state.T_left_board[i], posed[i], board_corners));
    scale = 3.0 * std::max(robustStddev(residuals), 0.01);
  }
  CameraStart refined = posesUnder(state.rig.left, views, board_corners);
  for (std::size_t i = 0, k = 0; i < views.size(); ++i) {
    if (start.T_camera_board[i]) refined.T_camera_board[i] = state.T_left_board[k++];
  }
  return refined;
}

/// The pose with the smallest sum of distances to the others: rotation in rad plus translation relative to
/// the baseline.
Eigen::Isometry3d medoid(const std::vector<Eigen::Isometry3d>& poses) {
  std::size_t best = 0;
  double least = kInfinity;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    double sum = 0.0;
    for (const Eigen::Isometry3d& other : poses) {
      const Eigen::Isometry3d difference = poses[i].inverse() * other;
      sum += Eigen::AngleAxisd(difference.linear()).angle() +
             difference.translation().norm() / std::max(other.translation().norm(), 1e-3);
    }
    if (sum < least) {
      least = sum;
      best = i;
    }
  }
  return poses[best];
}

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

double robustStddev(const std::vector<ViewResiduals>& residuals) {
  std::vector<double> norms;
  for (const ViewResiduals& view : residuals) {
    for (const auto* side : {&view.left, &view.right}) {
      for (const Eigen::Vector2d& residual : *side)
        norms.push_back(residual.norm());
    }
  }
  // The median norm of normal noise in two dimensions is sqrt(2 ln 2) standard deviations.
  constexpr double kMedianOfDistance = 1.1774100225154747;
  return medianOrInfinity(norms) / kMedianOfDistance;
}

RigAndBoards initialCalibration(const std::vector<BoardView>& views,
                                const std::vector<Eigen::Vector2d>& board_corners, cv::Size image_size,
                                LensModel lens) {
  const CameraStart left = startCamera(oneCamera(views, &BoardView::left), board_corners, image_size, lens);
  const CameraStart right = startCamera(oneCamera(views, &BoardView::right), board_corners, image_size, lens);
  std::vector<Eigen::Isometry3d> relative;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (left.T_camera_board[i] && right.T_camera_board[i])
      relative.push_back(*right.T_camera_board[i] * left.T_camera_board[i]->inverse());
  }
  if (relative.empty()) throw std::runtime_error("no view gives the pose of the board in both cameras");
  RigAndBoards start;
  start.rig.left = left.camera;
  start.rig.right = right.camera;
  start.rig.T_right_left = medoid(relative);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const auto& pose = left.T_camera_board[i];
    const auto& from_right = right.T_camera_board[i];
    if (!pose && !from_right)
      throw std::runtime_error("view '" + views[i].name + "' gives the pose of the board in neither camera");
    start.T_left_board.push_back(pose ? *pose : start.rig.T_right_left.inverse() * *from_right);
  }
  return start;
}

std::optional<Eigen::Isometry3d> fitBoardPose(const Rig& rig, const BoardView& view,
                                              const std::vector<Eigen::Vector2d>& board_corners,
                                              double robust_scale) {
  std::optional<Eigen::Isometry3d> start;
  if (view.left.size() >= view.right.size()) start = boardPose(rig.left, view.left, board_corners);
  if (!start) {
    start = boardPose(rig.right, view.right, board_corners);
    if (start) start = rig.T_right_left.inverse() * *start;
  }
  if (!start) start = boardPose(rig.left, view.left, board_corners);
  if (!start) return std::nullopt;
  const BoardAdjustment adjusted =
      adjustBoards({rig, {*start}}, {view}, board_corners, {{}, robust_scale, 0.0});
  if (!std::isfinite(adjusted.cost)) return std::nullopt;
  return adjusted.estimate.T_left_board.front();
}

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
