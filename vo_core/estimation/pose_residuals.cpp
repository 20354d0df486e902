// Sorting of points by anchor, copying into SIMD blocks, and summation of the normal equations.
#include "vo_core/estimation/pose_residuals.hpp"

#include <cmath>

namespace cartvo::vo {

PointBlock blockOf(const PoseProblem& problem, const int* points, int count) {
  PointBlock block;
  block.count = count;
  block.noise = 1.0 + DoubleLanes{};  // avoids a division by zero in unused lanes
  for (int lane = 0; lane < count; ++lane) {
    const PosePoint& point = problem.points[points[lane]];
    block.point[lane] = points[lane];
    for (int axis = 0; axis < 3; ++axis)
      block.place.bearing[axis][lane] = point.bearing[axis];
    block.place.inverse_depth[lane] = point.inverse_depth;
    block.inverse_depth_stddev[lane] = point.inverse_depth_stddev;
    for (int axis = 0; axis < 2; ++axis)
      block.left[axis][lane] = point.left[axis];
    block.weight[lane] = point.weight;
    block.noise[lane] = std::pow(problem.noise[point.level], 2) + point.row_noise * point.row_noise;
  }
  return block;
}

void PointBlocks::reset(const PoseProblem& problem) {
  order_.reserve(problem.points.capacity());
  order_.sort(problem.anchors.size(), problem.points.size(),
              [&](std::size_t i) { return problem.points[i].anchor; });
  blocks.clear();
  blocks.reserve(order_.maximumBlocks());
  order_.forEachBlock([&](int anchor, const int* points, int count) {
    blocks.push_back(blockOf(problem, points, count));
    blocks.back().anchor = anchor;
  });
}

Matrix6d PoseEquations::hessian() const {
  Matrix6d sums;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j <= i; ++j)
      sums(i, j) = sums(j, i) = sumOf(hessian_[i][j]);
  return sums;
}

Vector6d PoseEquations::gradient() const {
  Vector6d sums;
  for (int i = 0; i < 6; ++i)
    sums[i] = sumOf(gradient_.value[i]);
  return sums;
}

}  // namespace cartvo::vo
