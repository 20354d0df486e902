// Quadrilateral meshes and their texture gradients.
#include "lab/render/scene/mesh.hpp"

#include <cmath>
#include <numbers>

#include "lab/render/surface/hash.hpp"

namespace cartvo::world {
namespace {

/// Quantised normal: equal for two quadrilaterals of a wall, different for two faces of a box.
std::uint32_t facing(const Eigen::Vector3f& normal) {
  const auto coarse = [](float x) { return static_cast<std::uint32_t>(std::lround(x * 3.0F) + 8); };
  return coarse(normal.x()) | coarse(normal.y()) << 8U | coarse(normal.z()) << 16U;
}

}  // namespace

void Mesh::addQuad(const Corners& corners, const Coordinates& uv, const Finish& finish) {
  QuadShading shading;
  shading.uv = uv;
  shading.finish = finish;
  // Least squares over the diagonals: exact for a parallelogram, a mean for others.
  const Eigen::Vector3f d1 = corners[2] - corners[0];
  const Eigen::Vector3f d2 = corners[3] - corners[1];
  const Eigen::Vector2f t1 = uv[2] - uv[0];
  const Eigen::Vector2f t2 = uv[3] - uv[1];
  Eigen::Matrix2f gram;
  gram << d1.dot(d1), d1.dot(d2), d1.dot(d2), d2.dot(d2);
  const Eigen::Matrix2f inverse = (gram + 1e-12F * Eigen::Matrix2f::Identity()).inverse();
  const auto gradient = [&](int axis) -> Eigen::Vector3f {
    const Eigen::Vector2f weights = inverse * Eigen::Vector2f(t1[axis], t2[axis]);
    return d1 * weights.x() + d2 * weights.y();
  };
  shading.gradient_u = gradient(0);
  shading.gradient_v = gradient(1);
  const Eigen::Vector3f normal = d1.cross(d2).normalized();
  shading.surface = hashOf({static_cast<std::uint32_t>(finish.material), finish.seed, facing(normal)});
  shading_.push_back(shading);
  vertices_.insert(vertices_.end(), corners.begin(), corners.end());
}

void Mesh::addPlane(const Corners& corners, const Finish& finish) {
  const Eigen::Vector3f along = (corners[1] - corners[0]).normalized();
  const Eigen::Vector3f edge = corners[3] - corners[0];
  const Eigen::Vector3f across = (edge - edge.dot(along) * along).normalized();
  Coordinates uv;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3f offset = corners[i] - corners[0];
    uv[i] = {offset.dot(along), offset.dot(across)};
  }
  addQuad(corners, uv, finish);
}

void Mesh::addBox(const Eigen::Vector3f& base, const Eigen::Vector3f& size, float yaw, const Finish& finish) {
  const Eigen::Vector3f x = 0.5F * size.x() * Eigen::Vector3f(std::cos(yaw), std::sin(yaw), 0.0F);
  const Eigen::Vector3f y = 0.5F * size.y() * Eigen::Vector3f(-std::sin(yaw), std::cos(yaw), 0.0F);
  const Eigen::Vector3f z = size.z() * Eigen::Vector3f::UnitZ();
  const std::array<Eigen::Vector3f, 4> foot{base - x - y, base + x - y, base + x + y, base - x + y};
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3f& a = foot[i];
    const Eigen::Vector3f& b = foot[(i + 1) % 4];
    addPlane({a, b, b + z, a + z}, finish);
  }
  addPlane({foot[0] + z, foot[1] + z, foot[2] + z, foot[3] + z}, finish);
}

void Mesh::addColumn(const Eigen::Vector3f& from, const Eigen::Vector3f& to, float radius_from,
                     float radius_to, int sides, const Finish& finish) {
  const Eigen::Vector3f axis = (to - from).normalized();
  const Eigen::Vector3f x = axis.unitOrthogonal();
  const Eigen::Vector3f y = axis.cross(x);
  const float length = (to - from).norm();
  const auto direction = [&](int i) -> Eigen::Vector3f {
    const float angle = 2.0F * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(sides);
    return std::cos(angle) * x + std::sin(angle) * y;
  };
  const float face = 2.0F * std::numbers::pi_v<float> * radius_from / static_cast<float>(sides);
  for (int i = 0; i < sides; ++i) {
    const Eigen::Vector3f a = direction(i);
    const Eigen::Vector3f b = direction(i + 1);
    const float u = face * static_cast<float>(i);
    addQuad({from + radius_from * a, from + radius_from * b, to + radius_to * b, to + radius_to * a},
            rectangle(u, 0.0F, u + face, length), finish);
  }
}

void Mesh::addMesh(const Mesh& mesh, const Eigen::Affine3f& placement, std::uint32_t seed) {
  for (std::size_t quad = 0; quad < mesh.size(); ++quad) {
    const QuadShading& shading = mesh.shading_[quad];
    Corners corners;
    for (std::size_t i = 0; i < 4; ++i)
      corners[i] = placement * mesh.vertices_[4 * quad + i];
    Finish finish = shading.finish;
    finish.seed = mixBits(finish.seed ^ seed);
    addQuad(corners, shading.uv, finish);
  }
}

}  // namespace cartvo::world
