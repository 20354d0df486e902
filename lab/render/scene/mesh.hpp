#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "lab/render/surface/material.hpp"

namespace cartvo::world {

inline Eigen::Vector3f pointAt(const Eigen::Vector2d& place, double height) {
  return Eigen::Vector3d(place.x(), place.y(), height).cast<float>();
}

/// Material of a quadrilateral. Different seeds give different textures. Quadrilaterals with the same finish
/// are one surface to the anti-aliasing, so their texture coordinates must be continuous.
struct Finish {
  Material material = Material::concrete;
  std::uint32_t seed = 0;
  float tone = 0.5F;  ///< brightness or variant of the material, 0..1
};

/// Texture coordinates and finish of one quadrilateral.
struct QuadShading {
  std::array<Eigen::Vector2f, 4> uv;
  Eigen::Vector3f gradient_u;  ///< du/dP in mesh axes, about 1 in length: u and v are metres
  Eigen::Vector3f gradient_v;  ///< dv/dP
  Finish finish;
  std::uint32_t surface = 0;  ///< hash; equal for the same finish and facing direction
};

/// Two-sided quadrilaterals with their shading data. Corners are in cyclic order, m.
class Mesh {
 public:
  using Corners = std::array<Eigen::Vector3f, 4>;
  using Coordinates = std::array<Eigen::Vector2f, 4>;

  /// `uv`: texture coordinates of the corners, m.
  void addQuad(const Corners& corners, const Coordinates& uv, const Finish& finish);

  /// Texture coordinates from (u0, v0) at the first corner to (u1, v1) at the third.
  static Coordinates rectangle(float u0, float v0, float u1, float v1) {
    return {Eigen::Vector2f(u0, v0), Eigen::Vector2f(u1, v0), Eigen::Vector2f(u1, v1),
            Eigen::Vector2f(u0, v1)};
  }

  /// Adds a planar quad whose texture coordinates start at the first corner, u along the first edge.
  void addPlane(const Corners& corners, const Finish& finish);

  /// Adds an upright box: centre of its base, size along its axes, m, turned by `yaw`, rad.
  void addBox(const Eigen::Vector3f& base, const Eigen::Vector3f& size, float yaw, const Finish& finish);

  /// Adds a round column without end faces; it may be slanted and tapered. Radii in m.
  void addColumn(const Eigen::Vector3f& from, const Eigen::Vector3f& to, float radius_from, float radius_to,
                 int sides, const Finish& finish);

  /// Adds a copy of `mesh` at `placement`; `seed` is mixed into the seeds of its finishes.
  void addMesh(const Mesh& mesh, const Eigen::Affine3f& placement, std::uint32_t seed);

  std::size_t size() const { return shading_.size(); }
  const std::vector<Eigen::Vector3f>& vertices() const { return vertices_; }  ///< four per quad
  const QuadShading& shading(std::uint32_t quad) const { return shading_[quad]; }

 private:
  std::vector<Eigen::Vector3f> vertices_;
  std::vector<QuadShading> shading_;
};

}  // namespace cartvo::world
