// Normal equations of rows as sums of powers of the instants of points.
#include "vo_core/rolling_shutter/row_equations.hpp"

#include <vector>

#include "vo_core/geometry/reprojection_lanes.hpp"

namespace cartvo::vo {
namespace {

using Unknowns = RowUnknowns;

constexpr int kPose = 6, kTriangle = kPose * (kPose + 1) / 2;
constexpr int kOrders = 4;                // pose, velocity, acceleration, angular jerk
constexpr int kPowers = 2 * kOrders - 1;  // of the instant in a product of two derivatives
constexpr double kFactorials[kOrders] = {1.0, 1.0, 2.0, 6.0};

constexpr int triangleIndex(int i, int j) {
  return i >= j ? i * (i + 1) / 2 + j : triangleIndex(j, i);
}

/// First axis (of translation and rotation) that has unknowns of this order: the jerk is that of rotations.
constexpr int firstAxis(int order) {
  return order < kOrders - 1 ? 0 : 3;
}

/// Index of an unknown of the motion.
constexpr int unknownOf(int order, int axis) {
  return order * kPose + axis - firstAxis(order);
}

/// First entry of the triangle that a power is needed of: only rotations have a jerk.
constexpr int firstEntry(int power) {
  return power <= 2 * (kOrders - 2) ? 0 : triangleIndex(3, 0);
}

/// Up to four points, one in each lane. Lanes beyond have no weight.
struct PointLanes {
  DoubleLanes ray[3]{}, ray_by_depth[3]{}, ray_by_readout[3]{};
  DoubleLanes inverse_depth{}, depth_information{};
  DoubleLanes pixel[2]{};      // px
  DoubleLanes instant{};       // s
  DoubleLanes share{};         // of the readout
  DoubleLanes precision[2]{};  // 1/px
  DoubleLanes weight{};
  DoubleLanes depth_errors[Unknowns::kDepthErrors]{};  // 1/m, effects of unit errors on the inverse depth
};

/// Vector of three coordinates in lanes.
struct VectorLanes {
  DoubleLanes x, y, z;
};

inline void cross(const VectorLanes& a, const VectorLanes& b, VectorLanes& product) {
  product = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Rotates a vector by minus a rotation vector, to second order.
inline void rotateBack(const VectorLanes& turn, const VectorLanes& vector, VectorLanes& rotated) {
  VectorLanes first, second;
  cross(turn, vector, first);
  cross(turn, first, second);
  rotated = {vector.x - first.x + 0.5 * second.x, vector.y - first.y + 0.5 * second.y,
             vector.z - first.z + 0.5 * second.z};
}

/// Sums over all points, separately in each lane. "pose": derivatives by the pose at the point's instant;
/// those by velocity, acceleration and jerk are these times powers of the instant.
struct Sums {
  DoubleLanes pose_pose[kPowers][kTriangle]{};
  DoubleLanes pose_gradient[kOrders][kPose]{};
  DoubleLanes pose_depth[kOrders][kPose][Unknowns::kDepthErrors]{};
  DoubleLanes pose_readout[kOrders][kPose]{};
  DoubleLanes depth_depth[Unknowns::kDepthErrors][Unknowns::kDepthErrors]{};  // the lower triangle
  DoubleLanes depth_gradient[Unknowns::kDepthErrors]{}, depth_readout[Unknowns::kDepthErrors]{};
  DoubleLanes readout_readout{}, readout_gradient{};
};

/// One residual with its derivatives.
struct Residual {
  DoubleLanes value, by_inverse_depth, by_readout;
  DoubleLanes by_pose[kPose];
};

/// A point as the camera sees it at its instant.
struct InstantView {
  ViewLanes view;
  RayLanes by_depth, by_readout;  // derivatives of the ray; by the readout, that through the anchor
  PoseLanes column, row;
  DoubleLanes instant, half_square;
};

inline void see(const PointLanes& point, const RowState& state, InstantView& seen) {
  const Eigen::Matrix3d& R = state.change.linear();
  const Eigen::Vector3d& t = state.change.translation();
  const auto& [velocity, acceleration, angular_jerk] = state.motion;
  seen.instant = point.instant;
  seen.half_square = 0.5 * seen.instant * seen.instant;
  const DoubleLanes sixth_cube = seen.half_square * seen.instant / 3.0;
  DoubleLanes step[6];
  for (int i = 0; i < 6; ++i)
    step[i] = velocity[i] * seen.instant + acceleration[i] * seen.half_square;
  for (int i = 0; i < 3; ++i)
    step[3 + i] += angular_jerk[i] * sixth_cube;
  const VectorLanes shift{step[0], step[1], step[2]}, turn{step[3], step[4], step[5]};
  const auto at_instant = [&](const DoubleLanes* from, const DoubleLanes& depth, RayLanes& to) {
    const DoubleLanes x = from[0] - depth * t.x(), y = from[1] - depth * t.y(), z = from[2] - depth * t.z();
    const VectorLanes moved{R(0, 0) * x + R(1, 0) * y + R(2, 0) * z - depth * shift.x,
                            R(0, 1) * x + R(1, 1) * y + R(2, 1) * z - depth * shift.y,
                            R(0, 2) * x + R(1, 2) * y + R(2, 2) * z - depth * shift.z};
    VectorLanes turned;
    rotateBack(turn, moved, turned);
    to = {turned.x, turned.y, turned.z};
  };
  RayLanes ray;
  at_instant(point.ray, point.inverse_depth, ray);
  at_instant(point.ray_by_depth, 1.0 + DoubleLanes{}, seen.by_depth);
  at_instant(point.ray_by_readout, DoubleLanes{}, seen.by_readout);
  seen.view = viewOf(ray);
  PlaceLanes place{};
  place.inverse_depth = point.inverse_depth;
  seen.column = columnByCamera(seen.view, place);
  seen.row = rowByCamera(seen.view, place);
}

inline void setDerivatives(const PoseLanes& by_pose, const DoubleLanes& factor, const PointLanes& point,
                           const InstantView& seen, const ExposureMotion& motion, Residual& residual) {
  DoubleLanes by_instant{};
  for (int i = 0; i < kPose; ++i) {
    residual.by_pose[i] = factor * by_pose.value[i];
    by_instant += residual.by_pose[i] * (motion.velocity[i] + motion.acceleration[i] * seen.instant);
  }
  for (int i = 0; i < 3; ++i)
    by_instant += residual.by_pose[3 + i] * (motion.angular_jerk[i] * seen.half_square);
  residual.by_readout = point.share * by_instant;
}

/// Sums of products of a point's two residuals, with the inverse depth eliminated.
struct PointSums {
  DoubleLanes pose_pose[kTriangle], pose_gradient[kPose], pose_readout[kPose];
  DoubleLanes pose_depth[kPose];  // times the depth errors
  DoubleLanes depth_depth, depth_gradient, depth_readout, readout_readout, readout_gradient;
};

inline void sumPoint(const Residual (&residuals)[2], const DoubleLanes& weight,
                     const DoubleLanes& depth_information, PointSums& sums) {
  const auto& [u, v] = residuals;
  const DoubleLanes du = weight * u.by_inverse_depth, dv = weight * v.by_inverse_depth;
  const DoubleLanes depth = du * u.by_inverse_depth + dv * v.by_inverse_depth;
  // The depth's own weight follows that of the point; the constant is for lanes without one.
  const DoubleLanes variance = 1.0 / (depth + weight * depth_information + 1e-12);
  const DoubleLanes left = 1.0 - variance * depth;  // share that the elimination leaves
  const DoubleLanes depth_value = du * u.value + dv * v.value;
  const DoubleLanes depth_readout = du * u.by_readout + dv * v.by_readout;
  DoubleLanes eliminated[kPose];
  for (int i = 0; i < kPose; ++i) {
    const DoubleLanes depth_pose = du * u.by_pose[i] + dv * v.by_pose[i];
    const DoubleLanes wu = weight * u.by_pose[i], wv = weight * v.by_pose[i];
    eliminated[i] = depth_pose;
    const DoubleLanes scaled = variance * depth_pose;
    sums.pose_depth[i] = left * depth_pose;
    sums.pose_gradient[i] = wu * u.value + wv * v.value - scaled * depth_value;
    sums.pose_readout[i] = wu * u.by_readout + wv * v.by_readout - scaled * depth_readout;
    for (int j = 0; j <= i; ++j)
      sums.pose_pose[triangleIndex(i, j)] = wu * u.by_pose[j] + wv * v.by_pose[j] - scaled * eliminated[j];
  }
  sums.depth_depth = left * depth;
  sums.depth_gradient = left * depth_value;
  sums.depth_readout = left * depth_readout;
  sums.readout_readout = weight * (u.by_readout * u.by_readout + v.by_readout * v.by_readout) -
                         variance * depth_readout * depth_readout;
  sums.readout_gradient =
      weight * (u.by_readout * u.value + v.by_readout * v.value) - variance * depth_readout * depth_value;
}

inline void addPoint(const PointSums& point, const DoubleLanes& instant,
                     const DoubleLanes (&errors)[Unknowns::kDepthErrors], Sums& sums) {
  DoubleLanes power = 1.0 + DoubleLanes{};
  for (int order = 0; order < kPowers; ++order, power *= instant) {
    for (int i = firstEntry(order); i < kTriangle; ++i)
      sums.pose_pose[order][i] += power * point.pose_pose[i];
    if (order >= kOrders) continue;
    for (int i = firstAxis(order); i < kPose; ++i) {
      sums.pose_gradient[order][i] += power * point.pose_gradient[i];
      sums.pose_readout[order][i] += power * point.pose_readout[i];
      const DoubleLanes pose_depth = power * point.pose_depth[i];
      for (int k = 0; k < Unknowns::kDepthErrors; ++k)
        sums.pose_depth[order][i][k] += pose_depth * errors[k];
    }
  }
  for (int k = 0; k < Unknowns::kDepthErrors; ++k) {
    sums.depth_gradient[k] += point.depth_gradient * errors[k];
    sums.depth_readout[k] += point.depth_readout * errors[k];
    for (int l = 0; l <= k; ++l)
      sums.depth_depth[k][l] += point.depth_depth * errors[k] * errors[l];
  }
  sums.readout_readout += point.readout_readout;
  sums.readout_gradient += point.readout_gradient;
}

CARTVO_TARGET_CLONES
void addPoints(const StereoCamera& camera, double robust_width, const std::vector<PointLanes>& points,
               const RowState& state, Sums& sums) {
  const double f = camera.focal_length;
  const double robustness = 1.0 / (robust_width * robust_width);
  for (const PointLanes& point : points) {
    InstantView seen;
    see(point, state, seen);
    const PixelLanes by_depth = viewByRay(seen.view, seen.by_depth);
    const PixelLanes by_anchor_readout = viewByRay(seen.view, seen.by_readout);
    const DoubleLanes scale[2] = {f * point.precision[0], f * point.precision[1]};
    Residual residuals[2];
    auto& [column, row] = residuals;
    column.value = point.precision[0] * (point.pixel[0] - camera.cx) - scale[0] * seen.view.x;
    row.value = point.precision[1] * (point.pixel[1] - camera.cy) - scale[1] * seen.view.y;
    column.by_inverse_depth = scale[0] * by_depth.x;
    row.by_inverse_depth = scale[1] * by_depth.y;
    setDerivatives(seen.column, scale[0], point, seen, state.motion, column);
    setDerivatives(seen.row, scale[1], point, seen, state.motion, row);
    column.by_readout += scale[0] * by_anchor_readout.x;
    row.by_readout += scale[1] * by_anchor_readout.y;
    // The depth is not known exactly: without its share, residuals of new landmarks would pass for outliers.
    const DoubleLanes depth_variance = 1.0 / point.depth_information;
    DoubleLanes square{};
    for (const Residual& residual : residuals)
      square += 0.5 * residual.value * residual.value /
                (1.0 + depth_variance * residual.by_inverse_depth * residual.by_inverse_depth);
    PointSums point_sums;
    sumPoint(residuals, point.weight / (1.0 + robustness * square), point.depth_information, point_sums);
    addPoint(point_sums, seen.instant, point.depth_errors, sums);
  }
}

/// The equations with all lanes summed.
RowEquations equationsOf(const Sums& sums) {
  RowEquations equations;
  Unknowns::Matrix& H = equations.hessian;
  Unknowns::Vector& gradient = equations.gradient;
  for (int order = 0; order < kOrders; ++order) {
    for (int i = firstAxis(order); i < kPose; ++i) {
      const int row = unknownOf(order, i);
      const double factor = 1.0 / kFactorials[order];
      gradient[row] = factor * sumOf(sums.pose_gradient[order][i]);
      H(Unknowns::kReadout, row) = factor * sumOf(sums.pose_readout[order][i]);
      for (int k = 0; k < Unknowns::kDepthErrors; ++k)
        H(Unknowns::kDepths + k, row) = factor * sumOf(sums.pose_depth[order][i][k]);
      for (int other = 0; other <= order; ++other)
        for (int j = firstAxis(other); j < kPose; ++j)
          H(row, unknownOf(other, j)) =
              factor / kFactorials[other] * sumOf(sums.pose_pose[order + other][triangleIndex(i, j)]);
    }
  }
  for (int k = 0; k < Unknowns::kDepthErrors; ++k) {
    gradient[Unknowns::kDepths + k] = sumOf(sums.depth_gradient[k]);
    H(Unknowns::kReadout, Unknowns::kDepths + k) = sumOf(sums.depth_readout[k]);
    for (int l = 0; l <= k; ++l)
      H(Unknowns::kDepths + k, Unknowns::kDepths + l) = sumOf(sums.depth_depth[k][l]);
  }
  gradient[Unknowns::kReadout] = sumOf(sums.readout_gradient);
  H(Unknowns::kReadout, Unknowns::kReadout) = sumOf(sums.readout_readout);
  H.triangularView<Eigen::StrictlyUpper>() = H.transpose();
  return equations;
}

void fill(const RowMotionProblem& problem, std::vector<PointLanes>& lanes) {
  lanes.clear();
  lanes.reserve(problem.points.capacity() / kDoubleLanes + 1);
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    const int lane = static_cast<int>(i) % kDoubleLanes;
    if (lane == 0) {
      PointLanes& empty = lanes.emplace_back();
      empty.ray[2] = empty.depth_information = 1.0 + DoubleLanes{};
    }
    PointLanes& into = lanes.back();
    const RowPoint& point = problem.points[i];
    for (int axis = 0; axis < 3; ++axis) {
      into.ray[axis][lane] = point.ray[axis];
      into.ray_by_depth[axis][lane] = point.ray_by_inverse_depth[axis];
      into.ray_by_readout[axis][lane] = point.ray_by_readout[axis];
    }
    into.inverse_depth[lane] = point.inverse_depth;
    into.depth_information[lane] = point.inverse_depth_information;
    for (int axis = 0; axis < 2; ++axis) {
      into.pixel[axis][lane] = point.pixel[axis];
      into.precision[axis][lane] = 1.0 / (problem.noise[point.level].pixel * point.relative_noise[axis]);
    }
    into.instant[lane] = point.instant;
    into.share[lane] = point.share;
    into.depth_errors[0][lane] = point.inverse_depth;
    into.depth_errors[1][lane] = 1.0;
    into.depth_errors[2][lane] = point.bearing.y();
    into.depth_errors[3][lane] = point.inverse_depth * point.bearing.x();
    into.weight[lane] = point.weight;
  }
}

}  // namespace

struct RowPoints::Lanes {
  StereoCamera camera;
  double robust_width = 0.0;
  std::vector<PointLanes> points;
  Sums sums;
};

RowPoints::RowPoints() : lanes_(std::make_unique<Lanes>()) {}
RowPoints::RowPoints(RowPoints&&) noexcept = default;
RowPoints& RowPoints::operator=(RowPoints&&) noexcept = default;
RowPoints::~RowPoints() = default;

void RowPoints::set(const RowMotionProblem& problem) {
  lanes_->camera = problem.camera;
  lanes_->robust_width = problem.robust_width;
  fill(problem, lanes_->points);
}

RowEquations RowPoints::equationsAt(const RowState& state) const {
  lanes_->sums = {};
  addPoints(lanes_->camera, lanes_->robust_width, lanes_->points, state, lanes_->sums);
  return equationsOf(lanes_->sums);
}

}  // namespace cartvo::vo
