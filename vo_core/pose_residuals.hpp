#pragma once

#include <array>
#include <vector>

#include "vo_core/lane_order.hpp"
#include "vo_core/pose_search.hpp"
#include "vo_core/reprojection_lanes.hpp"

// The residuals of a pose search, four points at a time. Not for use outside of it.

namespace cartvo {

/// Up to four points, a lane each. Lanes beyond `count` weigh nothing.
struct PointBlock {
  int host = 0;  ///< of all
  int count = 0;
  std::array<int, kDoubleLanes> point{};  ///< index into the problem's
  PlaceLanes place{};
  DoubleLanes deviation{};  ///< 1/m, of the inverse depth
  DoubleLanes left[2]{};    ///< px
  DoubleLanes weight{};
  DoubleLanes noise{};  ///< px^2
};

/// A block of those points; the host is left open.
PointBlock blockOf(const PoseProblem& problem, const int* points, int count);

/// All points, those of one host together.
class PointBlocks {
 public:
  void take(const PoseProblem& problem);

  std::vector<PointBlock> blocks;

 private:
  LaneOrder order_;
};

/// Transforms that differ from lane to lane.
struct TransformLanes {
  DoubleLanes value[3][4];
  const DoubleLanes& operator()(int row, int column) const { return value[row][column]; }
};

/// Measured minus predicted, and how well that is known: the second coordinate is freed of what it shares
/// with the first by the depth's uncertainty (Cholesky's factors without square roots).
struct PointResiduals {
  ViewLanes view;
  DoubleLanes in_front;      ///< 1 or 0
  DoubleLanes residual[2];   ///< px
  DoubleLanes precision[2];  ///< 1/px^2
  DoubleLanes shared;        ///< so much of the first coordinate has been taken off the second
  DoubleLanes square;        ///< of the error in standard deviations, the mean of both coordinates
};

/// Inline: the callers are compiled per processor.
template <typename Transform>
inline PointResiduals residualsOf(const PoseProblem& problem, const Transform& T_camera_host,
                                  const PointBlock& block) {
  const StereoCamera& camera = problem.camera;
  const DoubleLanes& noise = block.noise;
  PointResiduals at;
  const RayLanes ray = rayOf(T_camera_host, block.place);
  BitLanes behind;
  findNegative(ray.z - kNearestRay, behind);
  onesWhere(~behind, at.in_front);
  at.view = viewOf(ray);
  const PixelLanes by_depth = viewByInverseDepth(T_camera_host, at.view);
  const DoubleLanes vague = camera.focal_length * block.deviation;
  const DoubleLanes vague_x = vague * by_depth.x, vague_y = vague * by_depth.y;
  at.precision[0] = 1.0 / (noise + vague_x * vague_x);
  at.precision[1] = 1.0 / (noise * (1.0 + vague_y * vague_y * at.precision[0]));
  at.shared = vague_x * vague_y * at.precision[0];
  at.residual[0] = block.left[0] - camera.cx - camera.focal_length * at.view.x;
  at.residual[1] = block.left[1] - camera.cy - camera.focal_length * at.view.y - at.shared * at.residual[0];
  at.square = 0.5 * (at.precision[0] * at.residual[0] * at.residual[0] +
                     at.precision[1] * at.residual[1] * at.residual[1]);
  return at;
}

/// The normal equations of a pose, each lane by itself.
class PoseEquations {
 public:
  /// `weight`: of each point. Inline, as residualsOf().
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

}  // namespace cartvo
