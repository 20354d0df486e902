// First estimate of a rig and its board poses, for the adjustment to start from.
#include "calib/solver/initial_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "calib/board/board_pose.hpp"
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

}  // namespace cartvo::calib
