// Summation of the normal equations over SIMD lanes and parts.
#include "vo_core/estimation/reduced_system.hpp"

#include <algorithm>

namespace cartvo::vo {

PoseVector sumOf(const PoseSums& sums) {
  PoseVector total(6 * static_cast<Eigen::Index>(sums.size()));
  for (int pose = 0; pose < static_cast<int>(sums.size()); ++pose)
    for (int i = 0; i < 6; ++i)
      total[6 * pose + i] = sumOf(sums[pose].value[i]);
  return total;
}

void ReducedSystem::reset(const BundleProblem& problem, const BundleBlocks& blocks) {
  free_ = static_cast<int>(problem.poses.size()) - problem.fixed;
  depths.reserve(blocks.landmarks.capacity());
  depths.resize(blocks.landmarks.size());
  for (Sums& sums : sums_) {
    sums.hessian.resize(free_ * (free_ + 1) / 2);
    sums.gradient.resize(free_);
  }
  by_poses_.reserve(free_ * blocks.landmarks.capacity());
  by_poses_.resize(free_ * blocks.landmarks.size());
}

void ReducedSystem::Sums::clear() {
  std::fill(hessian.begin(), hessian.end(), MatrixLanes{});
  std::fill(gradient.begin(), gradient.end(), PoseLanes{});
}

void ReducedSystem::Sums::add(const Sums& other) {
  for (std::size_t i = 0; i < hessian.size(); ++i)
    for (int row = 0; row < 6; ++row)
      for (int column = 0; column < 6; ++column)
        hessian[i].value[row][column] += other.hessian[i].value[row][column];
  for (std::size_t i = 0; i < gradient.size(); ++i)
    for (int row = 0; row < 6; ++row)
      gradient[i].value[row] += other.gradient[i].value[row];
}

void ReducedSystem::sumParts() {
  Sums& all = sums_.front();
  for (std::size_t part = 1; part < kParts; ++part)
    all.add(sums_[part]);
  const Eigen::Index size = 6 * free_;
  hessian.resize(size, size);
  for (int a = 0; a < free_; ++a)
    for (int b = 0; b <= a; ++b) {
      const MatrixLanes& lanes = all.hessianOf(a, b);
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j < (a == b ? i + 1 : 6); ++j) {
          const int at_a = 6 * a + i;
          const int at_b = 6 * b + j;
          hessian(at_a, at_b) = hessian(at_b, at_a) = sumOf(lanes.value[i][j]);
        }
    }
  gradient = sumOf(all.gradient);
}

}  // namespace cartvo::vo
