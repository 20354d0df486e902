#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "tools/world/material.hpp"

namespace cartvo::world {

/// What a quadrilateral is made of. `seed` tells apart what must not look alike; quads that share one are one
/// surface to the anti-aliasing, so their texture coordinates must continue each other.
struct Finish {
  Material material = Material::concrete;
  std::uint32_t seed = 0;
  float tone = 0.5F;  ///< the material's brightness or kind, 0..1
};

/// Texture coordinates and finish of one quadrilateral.
struct QuadShading {
  std::array<Eigen::Vector2f, 4> uv;
  Eigen::Vector3f gradient_u;  ///< du/dP, about 1 in length: texture coordinates are metres
  Eigen::Vector3f gradient_v;
  Finish finish;
  std::uint32_t surface = 0;  ///< equal for quads of one finish that face the same way
};

/// Quadrilaterals with what is needed to shade them. Corners go round; two-sided.
class Mesh {
 public:
  using Corners = std::array<Eigen::Vector3f, 4>;
  using Coordinates = std::array<Eigen::Vector2f, 4>;

  void addQuad(const Corners& corners, const Coordinates& uv, const Finish& finish);

  /// A planar quad whose texture coordinates are metres from its first corner, u along the first edge.
  void addPlane(const Corners& corners, const Finish& finish);

  /// An upright box: `centre` of its base, size along its axes, turned by `yaw`.
  void addBox(const Eigen::Vector3f& base, const Eigen::Vector3f& size, float yaw, const Finish& finish);

  /// A round, possibly slanted and tapering column without ends.
  void addColumn(const Eigen::Vector3f& from, const Eigen::Vector3f& to, float radius_from, float radius_to,
                 int sides, const Finish& finish);

  /// A copy of another mesh, moved, its finishes' seeds mixed with `seed`.
  void addMesh(const Mesh& mesh, const Eigen::Affine3f& placement, std::uint32_t seed);

  std::size_t size() const { return shading_.size(); }
  const std::vector<Eigen::Vector3f>& vertices() const { return vertices_; }  ///< four a quad
  const QuadShading& shading(std::uint32_t quad) const { return shading_[quad]; }

 private:
  std::vector<Eigen::Vector3f> vertices_;
  std::vector<QuadShading> shading_;
};

}  // namespace cartvo::world
