#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "calib/board/board_view.hpp"
#include "calib/model/projection.hpp"
#include "calib/model/rig.hpp"

// Bundle adjustment of a rig and of the boards in front of it.

namespace cartvo::calib {

/// The distortion coefficients that are estimated for each camera, besides focal lengths and principal point.
enum class CalibrationModel : std::uint8_t {
  brown2,  ///< k1 k2, the model of the thesis
  brown4,  ///< k1 k2 p1 p2, which Kalibr, EuRoC and ROS call radtan or plumb bob
  brown5,  ///< k1 k2 p1 p2 k3
  brown8,  ///< k1 k2 p1 p2 k3 k4 k5 k6
  wide,    ///< Kannala and Brandt's k1 k2 k3 k4
};

std::string modelName(CalibrationModel model);
LensModel lensOf(CalibrationModel model);

// Order of a rig's parameters: those of the left camera, of the right camera, a small rotation vector applied
// to T_right_left from the left (rad), its translation (m).
inline constexpr int kRightCamera = kCameraParameters;
inline constexpr int kRelativeRotation = 2 * kCameraParameters;
inline constexpr int kRelativeTranslation = kRelativeRotation + 3;
inline constexpr int kRigParameters = kRelativeTranslation + 3;

/// Indices of the parameters of one camera that are free in a model.
std::vector<int> freeCameraParameters(CalibrationModel model);

/// Indices of the free parameters of the whole rig: both cameras and their relative pose.
std::vector<int> freeRigParameters(CalibrationModel model);

/// A parameter's name for display, such as "left fx" or "translation x", and its unit.
struct ParameterName {
  std::string name, unit;
};
ParameterName parameterName(int rig_parameter, LensModel lens);

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
