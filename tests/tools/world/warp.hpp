#pragma once

#include <Eigen/Core>
#include <vector>

#include "tools/world/rendered_world.hpp"

namespace cartvo::test {

/// One image as it was rendered: which camera, when.
struct Exposure {
  int index = 0;
  CameraSide side = CameraSide::left;
};

/// What is left between two images of a world once truth and rendered depth have carried one onto the other.
struct WarpResidual {
  Eigen::Vector2d flow;      ///< where truth says the patch went, px
  Eigen::Vector2d residual;  ///< how far from there it is found, px
};

/// Warps `to` onto `from` through `from`'s depth and the true poses and measures the displacement that
/// remains, in floating point and in two steps, on patches that are static, seen by both, away from depth
/// edges, and textured.
std::vector<WarpResidual> warpResiduals(const world::RenderedWorld& world, const Exposure& from,
                                        const Exposure& to);

}  // namespace cartvo::test
