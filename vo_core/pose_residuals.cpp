// Points sorted by their hosts and laid side by side.
#include "vo_core/pose_residuals.hpp"

namespace cartvo {

PointBlock blockOf(const PoseProblem& problem, const int* points, int count) {
  PointBlock block;
  block.count = count;
  block.noise[0] = block.noise[1] = 1.0 + DoubleLanes{};  // nothing is divided by zero beyond the last lane
  for (int lane = 0; lane < count; ++lane) {
    const PosePoint& point = problem.points[points[lane]];
    block.point[lane] = points[lane];
    for (int axis = 0; axis < 3; ++axis)
      block.place.bearing[axis][lane] = point.bearing[axis];
    block.place.inverse_depth[lane] = point.inverse_depth;
    block.deviation[lane] = point.inverse_depth_deviation;
    for (int axis = 0; axis < 2; ++axis) {
      const double deviation = problem.noise[point.level].pixel * point.relative_noise[axis];
      block.left[axis][lane] = point.left[axis];
      block.noise[axis][lane] = deviation * deviation;
    }
    block.weight[lane] = point.weight;
  }
  return block;
}

void PointBlocks::take(const PoseProblem& problem) {
  order_.reserve(problem.points.capacity());
  order_.sort(problem.hosts.size(), problem.points.size(),
              [&](std::size_t i) { return problem.points[i].host; });
  blocks.clear();
  blocks.reserve(order_.mostBlocks());
  order_.forEachBlock([&](int host, const int* points, int count) {
    blocks.push_back(blockOf(problem, points, count));
    blocks.back().host = host;
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

}  // namespace cartvo
