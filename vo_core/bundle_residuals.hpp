#pragma once

#include <array>

#include "vo_core/bundle_blocks.hpp"
#include "vo_core/bundle_cameras.hpp"

// The residuals of a bundle, linearised, four landmarks at a time. All inline: their callers are compiled
// per processor. Not for use outside the bundle adjustment.

namespace cartvo {

constexpr int kRowPoses = 4;  // poses that one residual depends on at most

/// One residual of each of a block's landmarks: its derivative by the inverse depth and by the free poses.
struct RowLanes {
  DoubleLanes residual;  // measured minus predicted, in standard deviations
  DoubleLanes weight;    // zero where there is none
  DoubleLanes by_inverse_depth;
  int poses = 0;
  std::array<int, kRowPoses> pose{};  // counted from the first free one
  PoseLanes by_pose[kRowPoses];       // of these, the first `poses`

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

/// The residuals of one sighting.
struct SightingRows {
  enum Index { kColumn, kRow, kDisparity, kCount };
  RowLanes row[kCount];  // the first two, of the left position, not at the host, which defines it
};

/// What one pair sees of a block, and where it should.
struct BlockView {
  const SightingBlock& sighting;
  const PlaceLanes& place;
  int host;
  DoubleLanes seen, stereo;  ///< 1 where it counts, else 0
  ViewLanes left, right;

  bool isHost() const { return sighting.pose == host; }
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

class BlockResiduals {
 public:
  BlockResiduals(const BundleProblem& problem, const BundleCameras& cameras, double robust_width)
      : camera_(problem.camera),
        cameras_(cameras),
        fixed_(problem.fixed),
        standing_share_(problem.standing_share),
        robustness_(1.0 / (robust_width * robust_width)) {}

  /// 1 where all cameras that see a landmark have it in front of them, else 0.
  void findInFront(const LandmarkBlock& block, const SightingBlock* sightings, DoubleLanes& in_front) const {
    BitLanes behind{};
    const auto regard = [&](const RayLanes& ray, const DoubleLanes& seen) {
      const DoubleLanes beyond = seen * (ray.z - kNearestRay) + (1.0 - seen);  // what is not seen, anywhere
      behind |= reinterpret_cast<const BitLanes&>(beyond);
    };
    for (std::size_t i = block.first_sighting; i < block.last_sighting; ++i) {
      const SightingBlock& sighting = sightings[i];
      regard(rayOf(cameras_.leftFromHost(sighting.pose, block.host), block.place), sighting.seen);
      regard(rayOf(cameras_.rightFromHost(sighting.pose, block.host), block.place), sighting.stereo);
    }
    findNegative(reinterpret_cast<const DoubleLanes&>(behind), behind);
    onesWhere(~behind, in_front);
  }

  BlockView viewBy(const SightingBlock& sighting, int host, const PlaceLanes& place,
                   const DoubleLanes& in_front) const {
    return {sighting,
            place,
            host,
            in_front * sighting.seen,
            in_front * sighting.stereo,
            viewOf(rayOf(cameras_.leftFromHost(sighting.pose, host), place)),
            viewOf(rayOf(cameras_.rightFromHost(sighting.pose, host), place))};
  }

  void linearise(const BlockView& view, const DoubleLanes& weight, SightingRows& rows) const {
    if (!view.isHost())
      linearisePosition(view, weight, rows.row[SightingRows::kColumn], rows.row[SightingRows::kRow]);
    lineariseDisparity(view, weight, rows.row[SightingRows::kDisparity]);
  }

 private:
  void linearisePosition(const BlockView& view, const DoubleLanes& weight, RowLanes& column,
                         RowLanes& row) const {
    const SightingBlock& sighting = view.sighting;
    const DoubleLanes& column_precision = sighting.position_precision[0];
    const DoubleLanes& row_precision = sighting.position_precision[1];
    const DoubleLanes f_column = column_precision * camera_.focal_length;
    const DoubleLanes f_row = row_precision * camera_.focal_length;
    column.residual = column_precision * (sighting.left[0] - camera_.cx) - f_column * view.left.x;
    row.residual = row_precision * (sighting.left[1] - camera_.cy) - f_row * view.left.y;
    const DoubleLanes square = 0.5 * (column.residual * column.residual + row.residual * row.residual);
    const double share = sighting.pose < fixed_ ? standing_share_ : 1.0;
    column.weight = row.weight = share * weight * view.seen / (1.0 + robustness_ * square);
    const Eigen::Isometry3d& T = cameras_.leftFromHost(sighting.pose, view.host);
    const PixelLanes by_depth = viewByInverseDepth(T, view.left);
    column.by_inverse_depth = f_column * by_depth.x;
    row.by_inverse_depth = f_row * by_depth.y;
    column.poses = row.poses = 0;
    if (const int free = sighting.pose - fixed_; free >= 0) {
      column.add(free, f_column, columnByCamera(view.left, view.place));
      row.add(free, f_row, rowByCamera(view.left, view.place));
    }
    if (const int free = view.host - fixed_; free >= 0) {
      column.add(free, f_column, columnByHost(T, view.left, view.place));
      row.add(free, f_row, rowByHost(T, view.left, view.place));
    }
  }

  void lineariseDisparity(const BlockView& view, const DoubleLanes& weight, RowLanes& row) const {
    const SightingBlock& sighting = view.sighting;
    const DoubleLanes f = camera_.focal_length * sighting.disparity_precision;
    row.residual = sighting.disparity_precision * (sighting.left[0] - sighting.right[0]) -
                   f * (view.left.x - view.right.x);
    row.weight = weight * view.stereo / (1.0 + robustness_ * (row.residual * row.residual));
    const Eigen::Isometry3d& T_left = cameras_.leftFromHost(sighting.pose, view.host);
    const Eigen::Isometry3d& T_right = cameras_.rightFromHost(sighting.pose, view.host);
    row.by_inverse_depth =
        f * (viewByInverseDepth(T_left, view.left).x - viewByInverseDepth(T_right, view.right).x);
    row.poses = 0;
    if (const int free = sighting.pose - fixed_; free >= 0 && !view.isHost())
      row.add(free, f, columnByCamera(view.left, view.place));
    if (cameras_.rightIsFree(sighting.pose)) {
      const RightCamera& right = cameras_.right(sighting.pose);
      const PoseLanes by_right = columnByCamera(view.right, view.place);
      const auto by_pose = [&](int pose, const Matrix6d& by_it) {
        if (pose >= fixed_) row.add(pose - fixed_, -f, timesMatrix(by_right, by_it));
      };
      by_pose(sighting.pose, right.by_own);
      by_pose(right.neighbour, right.by_neighbour);
      by_pose(right.third, right.by_third);
    }
    if (const int free = view.host - fixed_; free >= 0) {
      if (!view.isHost()) row.add(free, f, columnByHost(T_left, view.left, view.place));
      row.add(free, -f, columnByHost(T_right, view.right, view.place));
    }
  }

  const StereoCamera& camera_;
  const BundleCameras& cameras_;
  int fixed_;
  double standing_share_;
  double robustness_;
};

}  // namespace cartvo
