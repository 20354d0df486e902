#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "vo_core/estimation/bundle_residuals.hpp"

// Normal equations of a bundle problem, reduced to the free poses by the Schur complement. Internal to the
// bundle adjustment.

namespace cartvo::vo {

/// Normal equations of the inverse depths of a block.
struct DepthBlock {
  DoubleLanes in_front{};  ///< 1 or 0; landmarks behind a camera are left out
  DoubleLanes hessian{}, gradient{};
  DoubleLanes variance{};  ///< 1 / hessian; 0 if the depth is not observable
};

/// Sums over landmarks for each free pose, kept separately in each lane.
using PoseSums = FixedVector<PoseLanes, kMaximumWindowPairs>;
/// Adds the lanes.
PoseVector sumOf(const PoseSums& sums);

/// Normal equations of the free poses after elimination of the inverse depths.
class ReducedSystem {
 public:
  /// Number of parts into which the blocks are divided for threads. Each part has its own sums, which are
  /// added in a fixed order, so that the result does not depend on the number of threads.
  static constexpr std::size_t kParts = 4;

  void reset(const BundleProblem& problem, const BundleBlocks& blocks);

  /// Builds the equations of one part of the blocks. For each block it calls visitor.begin(block),
  /// visitor.add(view, rows) for each observation and visitor.eliminate(block, depth, by_poses).
  /// Inline because the callers are compiled for several instruction sets; loops that are not unrolled keep
  /// the code small.
  template <typename Visitor>
  void build(const BundleBlocks& blocks, const BlockResiduals& residuals, std::size_t part,
             Visitor& visitor) {
    Sums& sums = sums_[part];
    sums.clear();
    const std::size_t count = blocks.landmarks.size();
    for (std::size_t i = count * part / kParts; i < count * (part + 1) / kParts; ++i) {
      const LandmarkBlock& block = blocks.landmarks[i];
      DepthBlock& depth = depths[i];
      PoseLanes* const by_poses = by_poses_.data() + free_ * i;
      begin(block, residuals, blocks.observations.data(), depth, by_poses);
      PlaceLanes place = block.place;
      place.inverse_depth *= depth.in_front;
      visitor.begin(block);
      for (std::size_t j = block.first_observation; j < block.last_observation; ++j) {
        const BlockView view = residuals.viewBy(blocks.observations[j], block.anchor, place, depth.in_front);
        ObservationRows rows;
        residuals.linearise(view, block.weight, rows);
        for (int row = view.isAnchor() ? ObservationRows::kDisparity : 0; row < ObservationRows::kCount;
             ++row)
          add(rows.row[row], depth, by_poses, sums);
        visitor.add(view, rows);
      }
      eliminate(depth, by_poses, sums);
      visitor.eliminate(block, depth, by_poses);
    }
  }

  /// Sums all parts and their lanes into `hessian` and `gradient`.
  void sumParts();

  /// Changes the inverse depths by the step of the poses (back substitution). Inline, see build().
  void updateDepths(const PoseVector& step, BundleBlocks& blocks) const {
    for (std::size_t i = 0; i < blocks.landmarks.size(); ++i) {
      DoubleLanes change = depths[i].gradient;
      for (int pose = 0; pose < free_; ++pose)
        for (int axis = 0; axis < 6; ++axis)
          change -= step[6 * pose + axis] * by_poses_[free_ * i + pose].value[axis];
      blocks.landmarks[i].place.inverse_depth += depths[i].variance * change;
    }
  }

  /// Off-diagonal Hessian blocks of a landmark block and each free pose.
  const PoseLanes* byPoses(std::size_t block) const { return by_poses_.data() + free_ * block; }

  PoseMatrix hessian;
  PoseVector gradient;
  std::vector<DepthBlock> depths;

 private:
  struct MatrixLanes {
    DoubleLanes value[6][6];
  };
  /// Sums of one part.
  struct Sums {
    std::vector<MatrixLanes> hessian;
    PoseSums gradient;

    /// Block (a, b) with a >= b. Only the lower triangle of a diagonal block is used.
    MatrixLanes& hessianOf(int a, int b) { return hessian[a * (a + 1) / 2 + b]; }
    void clear();
    void add(const Sums& other);
  };

  void begin(const LandmarkBlock& block, const BlockResiduals& residuals,
             const ObservationBlock* observations, DepthBlock& depth, PoseLanes* by_poses) const {
    residuals.findInFront(block, observations, depth.in_front);
    depth.hessian = depth.in_front * block.prior_information;
    const DoubleLanes away = block.prior_inverse_depth - block.place.inverse_depth;
    depth.gradient = depth.hessian * away;
    for (int pose = 0; pose < free_; ++pose)
      by_poses[pose] = {};
  }

  static void addProduct(int a, int b, const PoseLanes& weighted, const PoseLanes& other, Sums& sums) {
    MatrixLanes& into = sums.hessianOf(a, b);
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < (a == b ? i + 1 : 6); ++j)
        into.value[i][j] += weighted.value[i] * other.value[j];
  }

  static void add(const RowLanes& row, DepthBlock& depth, PoseLanes* by_poses, Sums& sums) {
    const DoubleLanes weighted_depth = row.weight * row.by_inverse_depth;
    depth.hessian += weighted_depth * row.by_inverse_depth;
    depth.gradient += weighted_depth * row.residual;
    const DoubleLanes weighted_residual = row.weight * row.residual;
#pragma GCC unroll 1
    for (int a = 0; a < row.poses; ++a) {
      const int pose = row.pose[a];
      PoseLanes weighted;
#pragma GCC unroll 1
      for (int i = 0; i < 6; ++i) {
        const DoubleLanes& derivative = row.by_pose[a].value[i];
        weighted.value[i] = row.weight * derivative;
        sums.gradient[pose].value[i] += weighted_residual * derivative;
        by_poses[pose].value[i] += weighted_depth * derivative;
      }
#pragma GCC unroll 1
      for (int b = 0; b < row.poses; ++b)
        if (row.pose[b] <= row.pose[a]) addProduct(pose, row.pose[b], weighted, row.by_pose[b], sums);
    }
  }

  /// Subtracts the Schur complement of the inverse depths.
  void eliminate(DepthBlock& depth, const PoseLanes* by_poses, Sums& sums) const {
    constexpr double kMinimumInformation = 1e-9;  // m^2
    BitLanes unobservable;
    findNegative(depth.hessian - kMinimumInformation, unobservable);
    DoubleLanes observable;
    onesWhere(~unobservable, observable);
    depth.hessian *= observable;
    depth.variance = observable / (depth.hessian + (1.0 - observable));
    for (int a = 0; a < free_; ++a) {
      PoseLanes weighted;
#pragma GCC unroll 1
      for (int i = 0; i < 6; ++i) {
        weighted.value[i] = -depth.variance * by_poses[a].value[i];
        sums.gradient[a].value[i] += weighted.value[i] * depth.gradient;
      }
      for (int b = 0; b <= a; ++b)
        addProduct(a, b, weighted, by_poses[b], sums);
    }
  }

  int free_ = 0;
  std::array<Sums, kParts> sums_;
  std::vector<PoseLanes> by_poses_;
};

}  // namespace cartvo::vo
