// Cross-validation of a calibration: error on views that were held out.
#include "calib/solver/cross_validation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <opencv2/core/utility.hpp>

#include "calib/solver/initial_calibration.hpp"
#include "calib/solver/rectified_points.hpp"

namespace cartvo::calib {
namespace {

/// Fits the board's pose to a held-out view. The error is infinite if that fails.
HeldOutView heldOut(const StereoCalibration& trained, const RectifiedPoints& rectified, const BoardView& view,
                    const std::vector<Eigen::Vector2d>& board_corners) {
  constexpr double kHuber = 2.5;  // standard deviations, as in the calibration itself
  HeldOutView result;
  result.vertical_disparities = verticalDisparities(rectified, view);
  const Rig& rig = trained.estimate.rig;
  const auto pose = fitBoardPose(rig, view, board_corners, kHuber * trained.corner_stddev);
  result.rms = pose ? residualRms(viewResiduals(rig, *pose, view, board_corners))
                    : std::numeric_limits<double>::infinity();
  return result;
}

void holdOut(int fold, int folds, const StereoCalibration& calibration, const std::vector<BoardView>& views,
             const std::vector<Eigen::Vector2d>& board_corners, std::vector<HeldOutView>& results) {
  const auto is_held_out = [&](std::size_t i) { return static_cast<int>(i) % folds == fold; };
  RigAndBoards start;
  start.rig = calibration.estimate.rig;
  std::vector<BoardView> others;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (is_held_out(i)) continue;
    others.push_back(views[i]);
    start.T_left_board.push_back(calibration.estimate.T_left_board[i]);
  }
  const StereoCalibration trained = calibrateStereoFrom(start, others, board_corners, calibration.model);
  const RectifiedPoints rectified(trained.estimate.rig);
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (is_held_out(i)) results[i] = heldOut(trained, rectified, views[i], board_corners);
  }
}

void summarise(const std::vector<BoardView>& views, CrossValidation& validation) {
  double squares = 0.0, corners = 0.0, vertical_squares = 0.0;
  std::vector<double> vertical;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const HeldOutView& view = validation.views[i];
    const auto count = static_cast<double>(views[i].left.size() + views[i].right.size());
    squares += view.rms * view.rms * count;
    corners += count;
    for (const double disparity : view.vertical_disparities) {
      vertical.push_back(std::abs(disparity));
      vertical_squares += disparity * disparity;
    }
  }
  validation.rms = std::sqrt(squares / corners);
  if (vertical.empty()) throw std::runtime_error("no corner is seen by both cameras");
  validation.vertical_disparity_rms = std::sqrt(vertical_squares / static_cast<double>(vertical.size()));
  std::sort(vertical.begin(), vertical.end());
  validation.vertical_disparity_p95 = vertical[vertical.size() * 95 / 100];
}

}  // namespace

CrossValidation crossValidate(const StereoCalibration& calibration, const std::vector<BoardView>& views,
                              const std::vector<Eigen::Vector2d>& board_corners, int folds) {
  CrossValidation validation;
  validation.views.resize(views.size());
  std::vector<std::string> problems(static_cast<std::size_t>(folds));
  cv::parallel_for_({0, folds}, [&](const cv::Range& range) {
    for (int fold = range.start; fold < range.end; ++fold) {
      try {
        holdOut(fold, folds, calibration, views, board_corners, validation.views);
      } catch (const std::exception& error) {
        problems[static_cast<std::size_t>(fold)] = error.what();
      }
    }
  });
  for (const std::string& problem : problems) {
    if (!problem.empty()) throw std::runtime_error(problem);
  }
  summarise(views, validation);
  return validation;
}

}  // namespace cartvo::calib
