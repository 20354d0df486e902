#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "calib/board/board_view.hpp"
#include "calib/model/rig.hpp"
#include "calib/solver/calibration_model.hpp"

// Bundle adjustment of a rig and of the boards in front of it.

namespace cartvo::calib {

/// Reprojection residuals of a view: detected minus projected corners, px, in the order of the view's
/// corners.
struct ViewResiduals {
  std::vector<Eigen::Vector2d> left, right;
};

/// A rig and the poses of the boards in front of it.
struct RigAndBoards {
  Rig rig;                                      ///< only its cameras and T_right_left are used
  std::vector<Eigen::Isometry3d> T_left_board;  ///< one per view
};

/// Computes the residuals of one view. They are infinite for a corner that the model cannot project.
ViewResiduals viewResiduals(const Rig& rig, const Eigen::Isometry3d& T_left_board, const BoardView& view,
                            const std::vector<Eigen::Vector2d>& board_corners);

/// Settings of the adjustment.
struct AdjustmentSettings {
  std::vector<int> free_parameters;  ///< of the rig, see calibration_model.hpp; empty: only the boards move
  double robust_scale = 1.0;         ///< px; larger residuals get less weight (P. J. Huber, 1964)
  /// Weight of a zero prior on the free distortion coefficients, px^2, for coefficients that the views do not
  /// determine. The variance of the corners corresponds to a prior with standard deviation 1.
  double distortion_weight = 0.0;
};

/// Result of the adjustment.
struct BoardAdjustment {
  RigAndBoards estimate;
  double cost = 0.0;  ///< sum of Huber's function over the residuals, plus the distortion prior, px^2
  Eigen::MatrixXd information;  ///< of the free parameters, with the boards' poses marginalised, px^-2
  bool converged = false;       ///< false also if the start cannot be projected
};

/// Estimates the rig and the board poses: Levenberg-Marquardt on the reprojection residuals of both cameras,
/// with the boards' poses eliminated by the Schur complement.
BoardAdjustment adjustBoards(const RigAndBoards& start, const std::vector<BoardView>& views,
                             const std::vector<Eigen::Vector2d>& board_corners,
                             const AdjustmentSettings& settings);

}  // namespace cartvo::calib
