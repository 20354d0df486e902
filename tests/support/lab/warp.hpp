#pragma once

#include <Eigen/Core>
#include <vector>

#include "lab/render/rendered_world.hpp"

namespace cartvo::test {

/// Identifies one rendered image: camera and frame index.
struct Exposure {
  int index = 0;
  capture::CameraSide side = capture::CameraSide::left;
};

/// Residual displacement of a patch after warping one image onto another by true poses and rendered depth.
struct WarpResidual {
  Eigen::Vector2d flow;      ///< true displacement of the patch, px
  Eigen::Vector2d residual;  ///< measured minus true displacement, px
};

/// Warps `to` onto `from` by `from`'s depth and the true poses and measures the remaining displacement in two
/// Lucas-Kanade steps, in floating point, on textured static patches that both images show away from depth
/// edges.
std::vector<WarpResidual> warpResiduals(const world::RenderedWorld& world, const Exposure& from,
                                        const Exposure& to);

}  // namespace cartvo::test
