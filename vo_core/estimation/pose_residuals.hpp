#pragma once

#include <array>
#include <vector>

#include "vo_core/estimation/pose_search.hpp"
#include "vo_core/geometry/reprojection_lanes.hpp"
#include "vo_core/simd/simd_groups.hpp"

// Residuals of a pose search, four points at a time. Internal to the pose search.

namespace cartvo::vo {

/// Up to four points, one in each lane. Lanes from `count` on have no weight.
struct PointBlock {
  int anchor = 0;  ///< common anchor of the points
  int count = 0;
  std::array<int, kDoubleLanes> point{};  ///< index into the problem's points
  PlaceLanes place{};
  DoubleLanes inverse_depth_stddev{};  ///< 1/m
  DoubleLanes left[2]{};               ///< px
  DoubleLanes weight{};
  DoubleLanes noise{};  ///< px^2, variance of each coordinate
};

/// Copies points into a block; leaves `anchor` at 0.
PointBlock blockOf(const PoseProblem& problem, const int* points, int count);

/// All points of a problem, sorted by anchor.
class PointBlocks {
 public:
  void reset(const PoseProblem& problem);

  std::vector<PointBlock> blocks;

 private:
  SimdGroups order_;
};

/// One transform for each lane.
struct TransformLanes {
  DoubleLanes value[3][4];
  const DoubleLanes& operator()(int row, int column) const { return value[row][column]; }
};

/// Measured minus predicted positions and their precision. The depth's uncertainty correlates the
/// coordinates; the second one is decorrelated from the first (LDL^T factors of the covariance).
struct PointResiduals {
  ViewLanes view;
  DoubleLanes in_front;      ///< 1 or 0
  DoubleLanes residual[2];   ///< px
  DoubleLanes precision[2];  ///< 1/px^2
  DoubleLanes shared;        ///< factor of the first residual that was subtracted from the second
  DoubleLanes square;        ///< squared normalised error, mean of both coordinates
};

/// Inline because the callers are compiled for several instruction sets.
template <typename Transform>
inline PointResiduals residualsOf(const PoseProblem& problem, const Transform& T_camera_anchor,
                                  const PointBlock& block) {
  const StereoCamera& camera = problem.camera;
  const DoubleLanes& noise = block.noise;
  PointResiduals at;
  const RayLanes ray = rayOf(T_camera_anchor, block.place);
  BitLanes behind;
  findNegative(ray.z - kNearestRay, behind);
  onesWhere(~behind, at.in_front);
  at.view = viewOf(ray);
  const PixelLanes by_depth = viewByInverseDepth(T_camera_anchor, at.view);
  const DoubleLanes depth_noise = camera.focal_length * block.inverse_depth_stddev;
  const DoubleLanes depth_noise_x = depth_noise * by_depth.x, depth_noise_y = depth_noise * by_depth.y;
  at.precision[0] = 1.0 / (noise + depth_noise_x * depth_noise_x);
  at.precision[1] = 1.0 / (noise * (1.0 + depth_noise_y * depth_noise_y * at.precision[0]));
  at.shared = depth_noise_x * depth_noise_y * at.precision[0];
  at.residual[0] = block.left[0] - camera.cx - camera.focal_length * at.view.x;
  at.residual[1] = block.left[1] - camera.cy - camera.focal_length * at.view.y - at.shared * at.residual[0];
  at.square = 0.5 * (at.precision[0] * at.residual[0] * at.residual[0] +
                     at.precision[1] * at.residual[1] * at.residual[1]);
  return at;
}

/// Normal equations of a pose, summed separately in each lane.
class PoseEquations {
 public:
  /// Adds a block with the points' weights. Inline, see residualsOf().
  void add(const PoseProblem& problem, const PointBlock& block, const PointResiduals& at,
           const DoubleLanes& weight) {
    const double f = problem.camera.focal_length;
    PoseLanes by_pose[2] = {columnByCamera(at.view, block.place), rowByCamera(at.view, block.place)};
    for (int i = 0; i < 6; ++i) {
      by_pose[0].value[i] *= f;
      by_pose[1].value[i] = f * by_pose[1].value[i] - at.shared * by_pose[0].value[i];
    }
    for (int row = 0; row < 2; ++row) {
      const DoubleLanes precision = weight * at.precision[row];
      for (int i = 0; i < 6; ++i) {
        const DoubleLanes weighted = precision * by_pose[row].value[i];
        gradient_.value[i] += weighted * at.residual[row];
        for (int j = 0; j <= i; ++j)
          hessian_[i][j] += weighted * by_pose[row].value[j];
      }
    }
  }

  Matrix6d hessian() const;
  Vector6d gradient() const;

 private:
  DoubleLanes hessian_[6][6]{};  // the lower triangle
  PoseLanes gradient_{};
};

}  // namespace cartvo::vo
