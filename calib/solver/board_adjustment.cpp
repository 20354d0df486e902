// Bundle adjustment of a rig and the boards in front of it, and the models of cameras.
#include "calib/solver/board_adjustment.hpp"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <limits>

namespace cartvo::calib {
namespace {

constexpr std::array kBrownNames{"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
constexpr std::array kWideNames{"fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4", "", "", "", ""};

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using RigMatrix = Eigen::Matrix<double, kRigParameters, kRigParameters>;
using RigVector = Eigen::Matrix<double, kRigParameters, 1>;
using RigByBoard = Eigen::Matrix<double, kRigParameters, 6>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Normal equations H step = g, partitioned into the rig and each board.
struct NormalEquations {
  double cost = 0.0;
  RigMatrix H_rig = RigMatrix::Zero();
  RigVector g_rig = RigVector::Zero();
  std::vector<RigByBoard> H_rig_board;
  std::vector<Matrix6d> H_board;
  std::vector<Vector6d> g_board;
};

Eigen::Matrix3d crossMatrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d K;
  K << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return K;
}

Eigen::Vector3d onBoard(const std::vector<Eigen::Vector2d>& board_corners, int id) {
  const Eigen::Vector2d& corner = board_corners[static_cast<std::size_t>(id)];
  return {corner.x(), corner.y(), 0.0};
}

struct HuberTerm {
  double cost = 0.0, weight = 1.0;
};

/// Huber's cost and weight of a residual with this squared norm.
HuberTerm huber(double squared, double scale) {
  const double norm = std::sqrt(squared);
  if (norm <= scale) return {squared, 1.0};
  return {2.0 * scale * norm - scale * scale, scale / norm};
}

/// Derivative of the point R X + t by a small rotation of the board about the left camera's axes and a
/// translation.
Eigen::Matrix<double, 3, 6> pointByBoard(const Eigen::Vector3d& turned) {
  Eigen::Matrix<double, 3, 6> J;
  J << -crossMatrix(turned), Eigen::Matrix3d::Identity();
  return J;
}

/// Adds one view's terms. Stops with infinite cost at a corner that cannot be projected.
void addView(const Rig& rig, const Eigen::Isometry3d& T_left_board, const BoardView& view,
             const std::vector<Eigen::Vector2d>& board_corners, double scale, NormalEquations& equations) {
  RigByBoard& H_rig_board = equations.H_rig_board.emplace_back(RigByBoard::Zero());
  Matrix6d& H_board = equations.H_board.emplace_back(Matrix6d::Zero());
  Vector6d& g_board = equations.g_board.emplace_back(Vector6d::Zero());
  const auto add = [&]<int Size>(const Eigen::Vector2d& residual, int first,
                                 const Eigen::Matrix<double, 2, Size>& J_rig,
                                 const Eigen::Matrix<double, 2, 6>& J_board) {
    const auto [cost, weight] = huber(residual.squaredNorm(), scale);
    equations.cost += cost;
    equations.H_rig.template block<Size, Size>(first, first) += weight * J_rig.transpose() * J_rig;
    equations.g_rig.template segment<Size>(first) += weight * J_rig.transpose() * residual;
    H_rig_board.template middleRows<Size>(first) += weight * J_rig.transpose() * J_board;
    H_board += weight * J_board.transpose() * J_board;
    g_board += weight * J_board.transpose() * residual;
  };
  for (const SeenCorner& corner : view.left) {
    const Eigen::Vector3d turned = T_left_board.linear() * onBoard(board_corners, corner.id);
    const auto seen = project(rig.left, turned + T_left_board.translation());
    if (!seen) {
      equations.cost = kInfinity;
      return;
    }
    add(Eigen::Vector2d(corner.pixel - seen->pixel), 0, seen->J_camera,
        Eigen::Matrix<double, 2, 6>(seen->J_point * pointByBoard(turned)));
  }
  // The right camera's parameters and the relative pose are adjacent.
  constexpr int kRightAndPose = kRigParameters - kRightCamera;
  const Eigen::Matrix3d R_right_left = rig.T_right_left.linear();
  for (const SeenCorner& corner : view.right) {
    const Eigen::Vector3d turned = T_left_board.linear() * onBoard(board_corners, corner.id);
    const Eigen::Vector3d turned_right = R_right_left * (turned + T_left_board.translation());
    const auto seen = project(rig.right, turned_right + rig.T_right_left.translation());
    if (!seen) {
      equations.cost = kInfinity;
      return;
    }
    Eigen::Matrix<double, 2, kRightAndPose> J_rig;
    J_rig << seen->J_camera, seen->J_point * pointByBoard(turned_right);
    add(Eigen::Vector2d(corner.pixel - seen->pixel), kRightCamera, J_rig,
        Eigen::Matrix<double, 2, 6>(seen->J_point * R_right_left * pointByBoard(turned)));
  }
}

void addDistortionPrior(const Rig& rig, const AdjustmentSettings& settings, NormalEquations& equations) {
  for (const int parameter : settings.free_parameters) {
    const bool is_left = parameter < kRightCamera;
    const int of_camera = is_left ? parameter : parameter - kRightCamera;
    if (of_camera < kDistortion || of_camera >= kCameraParameters) continue;
    const double coefficient = parametersOf(is_left ? rig.left : rig.right)[of_camera];
    equations.cost += settings.distortion_weight * coefficient * coefficient;
    equations.H_rig(parameter, parameter) += settings.distortion_weight;
    equations.g_rig[parameter] -= settings.distortion_weight * coefficient;
  }
}

NormalEquations buildEquations(const RigAndBoards& at, const std::vector<BoardView>& views,
                               const std::vector<Eigen::Vector2d>& board_corners,
                               const AdjustmentSettings& settings) {
  NormalEquations equations;
  for (std::size_t i = 0; i < views.size() && std::isfinite(equations.cost); ++i)
    addView(at.rig, at.T_left_board[i], views[i], board_corners, settings.robust_scale, equations);
  addDistortionPrior(at.rig, settings, equations);
  return equations;
}

/// Applies a step (rotation vector, translation) to a pose.
void applyPoseStep(const Vector6d& step, Eigen::Isometry3d& T) {
  const double angle = step.head<3>().norm();
  if (angle > 0.0) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle, step.head<3>() / angle));
    T.linear() = (turn * Eigen::Quaterniond(T.linear())).normalized().toRotationMatrix();
  }
  T.translation() += step.tail<3>();
}

/// Normal equations of the rig alone, after elimination of the boards.
struct ReducedEquations {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  std::vector<Eigen::LDLT<Matrix6d>> boards;
};

ReducedEquations eliminateBoards(const NormalEquations& equations, const std::vector<int>& free,
                                 double damping) {
  const auto count = static_cast<Eigen::Index>(free.size());
  ReducedEquations result;
  result.H = equations.H_rig(free, free);
  result.H.diagonal() *= 1.0 + damping;
  result.g = equations.g_rig(free);
  for (std::size_t i = 0; i < equations.H_board.size(); ++i) {
    Matrix6d H_board = equations.H_board[i];
    H_board.diagonal() *= 1.0 + damping;
    const Eigen::LDLT<Matrix6d>& board = result.boards.emplace_back(H_board);
    if (count == 0) continue;
    const Eigen::MatrixXd W = equations.H_rig_board[i](free, Eigen::all);
    result.H -= W * board.solve(W.transpose());
    result.g -= W * board.solve(equations.g_board[i]);
  }
  return result;
}

/// Solves the damped equations and applies the step.
RigAndBoards applyStep(const RigAndBoards& from, const NormalEquations& equations,
                       const std::vector<int>& free, double damping) {
  const ReducedEquations rig_alone = eliminateBoards(equations, free, damping);
  RigVector rig_step = RigVector::Zero();
  if (!free.empty()) {
    const Eigen::VectorXd free_step = rig_alone.H.ldlt().solve(rig_alone.g);
    rig_step(free) = free_step;
  }
  RigAndBoards to = from;
  setParameters(parametersOf(from.rig.left) + rig_step.head<kCameraParameters>(), to.rig.left);
  setParameters(parametersOf(from.rig.right) + rig_step.segment<kCameraParameters>(kRightCamera),
                to.rig.right);
  applyPoseStep(rig_step.tail<6>(), to.rig.T_right_left);
  for (std::size_t i = 0; i < equations.H_board.size(); ++i) {
    const Vector6d g = equations.g_board[i] - equations.H_rig_board[i].transpose() * rig_step;
    applyPoseStep(rig_alone.boards[i].solve(g), to.T_left_board[i]);
  }
  return to;
}

}  // namespace

std::string modelName(CalibrationModel model) {
  switch (model) {
    case CalibrationModel::brown2:
      return "brown2";
    case CalibrationModel::brown4:
      return "brown4";
    case CalibrationModel::brown5:
      return "brown5";
    case CalibrationModel::brown8:
      return "brown8";
    case CalibrationModel::wide:
      break;
  }
  return "wide";
}

LensModel lensOf(CalibrationModel model) {
  return model == CalibrationModel::wide ? LensModel::wide : LensModel::brown;
}

std::vector<int> freeCameraParameters(CalibrationModel model) {
  switch (model) {
    case CalibrationModel::brown2:
      return {0, 1, 2, 3, 4, 5};
    case CalibrationModel::brown4:
      return {0, 1, 2, 3, 4, 5, 6, 7};
    case CalibrationModel::brown5:
      return {0, 1, 2, 3, 4, 5, 6, 7, 8};
    case CalibrationModel::brown8:
      return {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
    case CalibrationModel::wide:
      break;
  }
  return {0, 1, 2, 3, 4, 5, 6, 7};
}

std::vector<int> freeRigParameters(CalibrationModel model) {
  const std::vector<int> camera = freeCameraParameters(model);
  std::vector<int> rig = camera;
  for (const int parameter : camera)
    rig.push_back(kRightCamera + parameter);
  for (int parameter = kRelativeRotation; parameter < kRigParameters; ++parameter)
    rig.push_back(parameter);
  return rig;
}

ParameterName parameterName(int rig_parameter, LensModel lens) {
  constexpr std::array kAxes{"x", "y", "z"};
  if (rig_parameter >= kRelativeTranslation) {
    return {
        std::string("translation ") + kAxes[static_cast<std::size_t>(rig_parameter - kRelativeTranslation)],
        "m"};
  }
  if (rig_parameter >= kRelativeRotation) {
    return {std::string("rotation ") + kAxes[static_cast<std::size_t>(rig_parameter - kRelativeRotation)],
            "rad"};
  }
  const bool is_left = rig_parameter < kRightCamera;
  const int parameter = is_left ? rig_parameter : rig_parameter - kRightCamera;
  const char* const name =
      (lens == LensModel::wide ? kWideNames : kBrownNames)[static_cast<std::size_t>(parameter)];
  return {std::string(is_left ? "left " : "right ") + name, parameter < kDistortion ? "px" : ""};
}

ViewResiduals viewResiduals(const Rig& rig, const Eigen::Isometry3d& T_left_board, const BoardView& view,
                            const std::vector<Eigen::Vector2d>& board_corners) {
  const auto residuals = [&](const CameraModel& camera, const Eigen::Isometry3d& T_camera_board,
                             const std::vector<SeenCorner>& seen) {
    std::vector<Eigen::Vector2d> result;
    for (const SeenCorner& corner : seen) {
      const auto projected = project(camera, T_camera_board * onBoard(board_corners, corner.id));
      result.emplace_back(projected ? Eigen::Vector2d(corner.pixel - projected->pixel)
                                    : Eigen::Vector2d::Constant(kInfinity));
    }
    return result;
  };
  return {residuals(rig.left, T_left_board, view.left),
          residuals(rig.right, rig.T_right_left * T_left_board, view.right)};
}

BoardAdjustment adjustBoards(const RigAndBoards& start, const std::vector<BoardView>& views,
                             const std::vector<Eigen::Vector2d>& board_corners,
                             const AdjustmentSettings& settings) {
  constexpr int kMaxSteps = 100;
  constexpr double kMinDamping = 1e-9, kMaxDamping = 1e9, kMinGain = 1e-8;
  const std::vector<int>& free = settings.free_parameters;
  BoardAdjustment result;
  result.estimate = start;
  NormalEquations equations = buildEquations(start, views, board_corners, settings);
  double damping = 1e-3;
  for (int step = 0; step < kMaxSteps && std::isfinite(equations.cost) && damping < kMaxDamping; ++step) {
    RigAndBoards next = applyStep(result.estimate, equations, free, damping);
    NormalEquations next_equations = buildEquations(next, views, board_corners, settings);
    if (!(next_equations.cost < equations.cost)) {  // also if it is not finite
      damping *= 10.0;
      result.converged = damping >= kMaxDamping;
      continue;
    }
    result.converged = equations.cost - next_equations.cost < kMinGain * equations.cost;
    result.estimate = std::move(next);
    equations = std::move(next_equations);
    damping = std::max(0.1 * damping, kMinDamping);
    if (result.converged) break;
  }
  result.cost = equations.cost;
  if (std::isfinite(result.cost)) result.information = eliminateBoards(equations, free, 0.0).H;
  return result;
}

}  // namespace cartvo::calib
