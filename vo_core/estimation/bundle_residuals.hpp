#pragma once

#include <array>

#include "vo_core/estimation/bundle_blocks.hpp"
#include "vo_core/estimation/bundle_cameras.hpp"

// Linearised residuals of a bundle problem, four landmarks at a time. All functions are inline because their
// callers are compiled for several instruction sets. Internal to the bundle adjustment.

namespace cartvo::vo {

constexpr int kRowPoses = 4;  // maximum number of poses that one residual depends on

/// One residual of each landmark of a block, with derivatives by the inverse depth and the free poses.
struct RowLanes {
  DoubleLanes residual;  // measured minus predicted, in standard deviations
  DoubleLanes weight;    // zero if the landmark has no such residual
  DoubleLanes by_inverse_depth;
  int poses = 0;
  std::array<int, kRowPoses> pose{};  // index, counted from the first free pose
  PoseLanes by_pose[kRowPoses];       // the first `poses` are valid

  /// Adds factor * derivative to the derivative by free pose `index`.
  void add(int index, const DoubleLanes& factor, const PoseLanes& derivative) {
    int at = 0;
    while (at < poses && pose[at] != index)
      ++at;
    if (at == poses) {
      pose[poses++] = index;
      by_pose[at] = {};
    }
#pragma GCC unroll 1
    for (int i = 0; i < 6; ++i)
      by_pose[at].value[i] += factor * derivative.value[i];
  }
};

/// Residuals of one observation.
struct ObservationRows {
  enum Index { kColumn, kRow, kDisparity, kCount };
  RowLanes row[kCount];  // kColumn and kRow are unset in the anchor
};

/// Observations of a block by one pair and the predicted views.
struct BlockView {
  const ObservationBlock& observation;
  const PlaceLanes& place;
  int anchor;
  DoubleLanes seen, stereo;  ///< 1 if observed (in both images) and in front of the cameras, else 0
  ViewLanes left, right;

  bool isAnchor() const { return observation.pose == anchor; }
};

/// derivative * matrix
inline PoseLanes timesMatrix(const PoseLanes& derivative, const Matrix6d& matrix) {
  PoseLanes product{};
  for (int j = 0; j < 6; ++j)
#pragma GCC unroll 1
    for (int i = 0; i < 6; ++i)
      product.value[j] += matrix(i, j) * derivative.value[i];
  return product;
}

/// Computes residuals, Cauchy weights and derivatives.
class BlockResiduals {
 public:
  BlockResiduals(const BundleProblem& problem, const BundleCameras& cameras, double robust_width)
      : camera_(problem.camera),
        cameras_(cameras),
        fixed_(problem.fixed),
        fixed_pose_weight_(problem.fixed_pose_weight),
        robustness_(1.0 / (robust_width * robust_width)) {}

  /// Sets lanes to 1 if the landmark is in front of all cameras that observe it, else to 0.
  void findInFront(const LandmarkBlock& block, const ObservationBlock* observations,
                   DoubleLanes& in_front) const {
    BitLanes behind{};
    const auto check = [&](const RayLanes& ray, const DoubleLanes& seen) {
      const DoubleLanes beyond = seen * (ray.z - kNearestRay) + (1.0 - seen);  // 1 if not observed
      behind |= reinterpret_cast<const BitLanes&>(beyond);
    };
    for (std::size_t i = block.first_observation; i < block.last_observation; ++i) {
      const ObservationBlock& observation = observations[i];
      check(rayOf(cameras_.leftFromAnchor(observation.pose, block.anchor), block.place), observation.seen);
      check(rayOf(cameras_.rightFromAnchor(observation.pose, block.anchor), block.place), observation.stereo);
    }
    findNegative(reinterpret_cast<const DoubleLanes&>(behind), behind);
    onesWhere(~behind, in_front);
  }

  BlockView viewBy(const ObservationBlock& observation, int anchor, const PlaceLanes& place,
                   const DoubleLanes& in_front) const {
    return {observation,
            place,
            anchor,
            in_front * observation.seen,
            in_front * observation.stereo,
            viewOf(rayOf(cameras_.leftFromAnchor(observation.pose, anchor), place)),
            viewOf(rayOf(cameras_.rightFromAnchor(observation.pose, anchor), place))};
  }

  void linearise(const BlockView& view, const DoubleLanes& weight, ObservationRows& rows) const {
    if (!view.isAnchor())
      linearisePosition(view, weight, rows.row[ObservationRows::kColumn], rows.row[ObservationRows::kRow]);
    lineariseDisparity(view, weight, rows.row[ObservationRows::kDisparity]);
  }

 private:
  void linearisePosition(const BlockView& view, const DoubleLanes& weight, RowLanes& column,
                         RowLanes& row) const {
    const ObservationBlock& observation = view.observation;
    const DoubleLanes& column_precision = observation.position_precision[0];
    const DoubleLanes& row_precision = observation.position_precision[1];
    const DoubleLanes f_column = column_precision * camera_.focal_length;
    const DoubleLanes f_row = row_precision * camera_.focal_length;
    column.residual = column_precision * (observation.left[0] - camera_.cx) - f_column * view.left.x;
    row.residual = row_precision * (observation.left[1] - camera_.cy) - f_row * view.left.y;
    const DoubleLanes square = 0.5 * (column.residual * column.residual + row.residual * row.residual);
    const double pose_weight = observation.pose < fixed_ ? fixed_pose_weight_ : 1.0;
    column.weight = row.weight = pose_weight * weight * view.seen / (1.0 + robustness_ * square);
    const Eigen::Isometry3d& T = cameras_.leftFromAnchor(observation.pose, view.anchor);
    const PixelLanes by_depth = viewByInverseDepth(T, view.left);
    column.by_inverse_depth = f_column * by_depth.x;
    row.by_inverse_depth = f_row * by_depth.y;
    column.poses = row.poses = 0;
    if (const int free = observation.pose - fixed_; free >= 0) {
      column.add(free, f_column, columnByCamera(view.left, view.place));
      row.add(free, f_row, rowByCamera(view.left, view.place));
    }
    if (const int free = view.anchor - fixed_; free >= 0) {
      column.add(free, f_column, columnByAnchor(T, view.left, view.place));
      row.add(free, f_row, rowByAnchor(T, view.left, view.place));
    }
  }

  void lineariseDisparity(const BlockView& view, const DoubleLanes& weight, RowLanes& row) const {
    const ObservationBlock& observation = view.observation;
    const DoubleLanes f = camera_.focal_length * observation.disparity_precision;
    row.residual = observation.disparity_precision * (observation.left[0] - observation.right[0]) -
                   f * (view.left.x - view.right.x);
    row.weight = weight * view.stereo / (1.0 + robustness_ * (row.residual * row.residual));
    const Eigen::Isometry3d& T_left = cameras_.leftFromAnchor(observation.pose, view.anchor);
    const Eigen::Isometry3d& T_right = cameras_.rightFromAnchor(observation.pose, view.anchor);
    row.by_inverse_depth =
        f * (viewByInverseDepth(T_left, view.left).x - viewByInverseDepth(T_right, view.right).x);
    row.poses = 0;
    if (const int free = observation.pose - fixed_; free >= 0 && !view.isAnchor())
      row.add(free, f, columnByCamera(view.left, view.place));
    if (cameras_.rightIsFree(observation.pose)) {
      const RightCamera& right = cameras_.right(observation.pose);
      const PoseLanes by_right = columnByCamera(view.right, view.place);
      const auto by_pose = [&](int pose, const Matrix6d& by_it) {
        if (pose >= fixed_) row.add(pose - fixed_, -f, timesMatrix(by_right, by_it));
      };
      by_pose(observation.pose, right.by_own);
      by_pose(right.neighbour, right.by_neighbour);
      by_pose(right.third, right.by_third);
    }
    if (const int free = view.anchor - fixed_; free >= 0) {
      if (!view.isAnchor()) row.add(free, f, columnByAnchor(T_left, view.left, view.place));
      row.add(free, -f, columnByAnchor(T_right, view.right, view.place));
    }
  }

  const StereoCamera& camera_;
  const BundleCameras& cameras_;
  int fixed_;
  double fixed_pose_weight_;
  double robustness_;
};

}  // namespace cartvo::vo
