#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "lab/render/surface/hash.hpp"

namespace cartvo::world {

/// One placement of a mesh on the campus, with its own texture seed and brightness.
struct Instance {
  std::uint32_t mesh = 0;                                   ///< index into Campus::meshes
  Eigen::Affine3f placement = Eigen::Affine3f::Identity();  ///< mesh to campus, m
  std::uint32_t seed = 0;   ///< mixed into the seeds of its surfaces; 0: unchanged
  float tone_shift = 0.0F;  ///< added to the tone of paint, cloth and leaves
  bool moving = false;
  float sway = 0.0F;  ///< rad, to which wind bends it
};

inline Eigen::Affine3f toAffine(const Eigen::Isometry3d& pose) {
  return Eigen::Affine3f(pose.matrix().cast<float>());
}

/// An instance with a look of its own.
inline Instance paintedInstance(std::uint32_t mesh, Random& random) {
  Instance instance;
  instance.mesh = mesh;
  instance.seed = random.bits();
  instance.tone_shift = random.real(-0.45, 0.5);
  return instance;
}

}  // namespace cartvo::world
