#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "vo_core/bundle_residuals.hpp"

// Not for use outside the bundle adjustment.

namespace cartvo {

/// How the inverse depths of a block hang together with the poses.
struct DepthBlock {
  DoubleLanes in_front{};  ///< 1 or 0: what a camera has behind it takes no part
  DoubleLanes hessian{}, gradient{};
  DoubleLanes variance{};  ///< 1 / hessian, or zero where the depth is left open
};

/// What is added up over landmarks, times the free poses: a lane's each by itself.
using PoseSums = FixedVector<PoseLanes, kMostWindowPairs>;
PoseVector sumOf(const PoseSums& sums);

/// The normal equations, the inverse depths eliminated.
class ReducedSystem {
 public:
  /// The blocks are divided so that threads can share the work. Each part is added up by itself, and the
  /// parts in their order: the same bits on any number of threads.
  static constexpr std::size_t kParts = 4;

  void reset(const BundleProblem& problem, const BundleBlocks& blocks);

  /// Builds the equations of one part of the blocks; `visit` sees, of each block,
  ///   begin(block), add(view, rows) for each sighting, and eliminate(block, depth, by_poses).
  /// Inline: the callers are compiled per processor; what is not unrolled keeps them small.
  template <typename Visit>
  void build(const BundleBlocks& blocks, const BlockResiduals& residuals, std::size_t part, Visit& visit) {
    Sums& sums = sums_[part];
    sums.clear();
    const std::size_t count = blocks.landmarks.size();
    for (std::size_t i = count * part / kParts; i < count * (part + 1) / kParts; ++i) {
      const LandmarkBlock& block = blocks.landmarks[i];
      DepthBlock& depth = depths[i];
      PoseLanes* const by_poses = by_poses_.data() + free_ * i;
      begin(block, residuals, blocks.sightings.data(), depth, by_poses);
      PlaceLanes place = block.place;
      place.inverse_depth *= depth.in_front;
      visit.begin(block);
      for (std::size_t j = block.first_sighting; j < block.last_sighting; ++j) {
        const BlockView view = residuals.viewBy(blocks.sightings[j], block.host, place, depth.in_front);
        SightingRows rows;
        residuals.linearise(view, block.weight, rows);
        for (int row = view.isHost() ? SightingRows::kDisparity : 0; row < SightingRows::kCount; ++row)
          add(rows.row[row], depth, by_poses, sums);
        visit.add(view, rows);
      }
      eliminate(depth, by_poses, sums);
      visit.eliminate(block, depth, by_poses);
    }
  }

  /// What has been built of all parts, added up.
  void conclude();

  /// The poses' step, applied to the inverse depths. Inline, as build().
  void takeStep(const PoseVector& step, BundleBlocks& blocks) const {
    for (std::size_t i = 0; i < blocks.landmarks.size(); ++i) {
      DoubleLanes change = depths[i].gradient;
      for (int pose = 0; pose < free_; ++pose)
        for (int axis = 0; axis < 6; ++axis)
          change -= step[6 * pose + axis] * by_poses_[free_ * i + pose].value[axis];
      blocks.landmarks[i].place.inverse_depth += depths[i].variance * change;
    }
  }

  const PoseLanes* byPoses(std::size_t block) const { return by_poses_.data() + free_ * block; }

  PoseMatrix hessian;
  PoseVector gradient;
  std::vector<DepthBlock> depths;

 private:
  struct MatrixLanes {
    DoubleLanes value[6][6];
  };
  /// Of one part.
  struct Sums {
    std::vector<MatrixLanes> hessian;
    PoseSums gradient;

    /// a >= b. Of a diagonal block, the lower triangle is used.
    MatrixLanes& hessianOf(int a, int b) { return hessian[a * (a + 1) / 2 + b]; }
    void clear();
    void add(const Sums& other);
  };

  void begin(const LandmarkBlock& block, const BlockResiduals& residuals, const SightingBlock* sightings,
             DepthBlock& depth, PoseLanes* by_poses) const {
    residuals.findInFront(block, sightings, depth.in_front);
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

  /// The Schur complement.
  void eliminate(DepthBlock& depth, const PoseLanes* by_poses, Sums& sums) const {
    constexpr double kLeastInformation = 1e-9;
    BitLanes little;
    findNegative(depth.hessian - kLeastInformation, little);
    DoubleLanes told;
    onesWhere(~little, told);
    depth.hessian *= told;
    depth.variance = told / (depth.hessian + (1.0 - told));
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

}  // namespace cartvo
