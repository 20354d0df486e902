#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "calib/board_view.hpp"
#include "calib/calibration_model.hpp"
#include "calib/rig.hpp"

namespace cartvo {

/// What a view's corners lack to the rig's projection: seen minus projected, px, in the order of the view's.
struct ViewResiduals {
  std::vector<Eigen::Vector2d> left, right;
};

/// Where a rig and the boards before it stand.
struct RigAndBoards {
  Rig rig;                                      ///< its cameras and T_right_left; the rest is let be
  std::vector<Eigen::Isometry3d> T_left_board;  ///< one for each view
};

/// The residuals of one view. A corner that the model cannot project gets infinite ones.
ViewResiduals viewResiduals(const Rig& rig, const Eigen::Isometry3d& T_left_board, const BoardView& view,
                            const std::vector<Eigen::Vector2d>& board_corners);

struct AdjustmentSettings {
  std::vector<int> free_parameters;  ///< of the rig, see calibration_model.hpp; none: only the boards move
  double robust_scale = 1.0;         ///< px; residuals beyond weigh less (P. J. Huber, 1964)
  /// Weight of the free distortion coefficients' squares, px^2: what the views do not tell stays near zero.
  /// The square of the corners' deviation takes coefficients for about as large as 1.
  double distortion_weight = 0.0;
};

struct BoardAdjustment {
  RigAndBoards estimate;
  double cost = 0.0;  ///< sum of Huber's function of the corners' residuals and the distortion's part, px^2
  Eigen::MatrixXd information;  ///< of the free parameters, the boards' poses eliminated, px^-2
  bool converged = false;       ///< false also where the start cannot be projected
};

/// The rig and boards that show the views best: Levenberg and Marquardt's method on the distances between
/// seen and projected corners of both cameras, the boards' poses eliminated by the Schur complement.
BoardAdjustment adjustBoards(const RigAndBoards& start, const std::vector<BoardView>& views,
                             const std::vector<Eigen::Vector2d>& board_corners,
                             const AdjustmentSettings& settings);

}  // namespace cartvo
