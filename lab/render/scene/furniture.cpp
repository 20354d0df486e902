// Builds the meshes of street furniture, fences and garden walls.
#include "lab/render/scene/furniture.hpp"

#include <algorithm>
#include <cmath>

#include "lab/render/scene/steps.hpp"
#include "lab/render/surface/hash.hpp"

namespace cartvo::world {

using Eigen::Vector3f;

Mesh makeLampPost() {
  Mesh mesh;
  const Finish metal{Material::metal, 11, 0.25F};
  mesh.addColumn(Vector3f(0, 0, -0.1F), Vector3f(0, 0, 0.9F), 0.085F, 0.08F, 12, metal);
  mesh.addColumn(Vector3f(0, 0, 0.9F), Vector3f(0, 0, 5.2F), 0.055F, 0.04F, 10, metal);
  mesh.addColumn(Vector3f(0, 0, 5.15F), Vector3f(1.1F, 0, 5.45F), 0.035F, 0.03F, 8, metal);
  mesh.addBox(Vector3f(1.25F, 0, 5.38F), Vector3f(0.55F, 0.22F, 0.12F), 0.0F, {Material::metal, 12, 0.9F});
  return mesh;
}

Mesh makeSign(std::uint32_t seed) {
  Mesh mesh;
  mesh.addColumn(Vector3f(0.03F, 0, -0.1F), Vector3f(0.03F, 0, 2.5F), 0.03F, 0.03F, 8,
                 {Material::metal, 13, 0.6F});
  const Finish board{Material::sign, seed, 0.5F};
  const auto corner = [](float y, float z) { return Vector3f(-0.005F, y, z); };
  mesh.addPlane({corner(0.3F, 1.85F), corner(-0.3F, 1.85F), corner(-0.3F, 2.45F), corner(0.3F, 2.45F)},
                board);
  return mesh;
}

Mesh makeBollard() {
  Mesh mesh;
  mesh.addColumn(Vector3f(0, 0, -0.1F), Vector3f(0, 0, 0.7F), 0.08F, 0.07F, 10, {Material::metal, 14, 0.1F});
  mesh.addColumn(Vector3f(0, 0, 0.7F), Vector3f(0, 0, 0.85F), 0.075F, 0.06F, 10, {Material::metal, 15, 1.0F});
  mesh.addColumn(Vector3f(0, 0, 0.85F), Vector3f(0, 0, 0.92F), 0.06F, 0.0F, 10, {Material::metal, 14, 0.1F});
  return mesh;
}

Mesh makeBench() {
  Mesh mesh;
  const Finish wood{Material::wood, 16, 0.6F};
  const Finish iron{Material::metal, 17, 0.05F};
  for (int i = 0; i < 4; ++i) {
    const float y = -0.2F + 0.12F * static_cast<float>(i);
    mesh.addBox(Vector3f(0, y, 0.43F), Vector3f(1.7F, 0.1F, 0.035F), 0.0F, wood);
    if (i > 0)
      mesh.addBox(Vector3f(0, 0.26F, 0.4F + 0.14F * static_cast<float>(i)), Vector3f(1.7F, 0.03F, 0.1F), 0.0F,
                  wood);
  }
  for (const float x : {-0.7F, 0.7F}) {
    mesh.addBox(Vector3f(x, 0.0F, 0.38F), Vector3f(0.05F, 0.5F, 0.05F), 0.0F, iron);
    mesh.addBox(Vector3f(x, -0.2F, -0.05F), Vector3f(0.05F, 0.05F, 0.45F), 0.0F, iron);
    mesh.addBox(Vector3f(x, 0.24F, -0.05F), Vector3f(0.05F, 0.05F, 0.95F), 0.0F, iron);
  }
  return mesh;
}

Mesh makeBin() {
  Mesh mesh;
  mesh.addColumn(Vector3f(0, 0, -0.05F), Vector3f(0, 0, 0.85F), 0.2F, 0.25F, 12,
                 {Material::metal, 18, 0.15F});
  mesh.addColumn(Vector3f(0, 0, 0.85F), Vector3f(0, 0, 0.98F), 0.27F, 0.12F, 12, {Material::metal, 19, 0.5F});
  return mesh;
}

Mesh makeRailingPiece(double length) {
  constexpr float kHeight = 1.15F;       // m
  constexpr double kBarSpacing = 0.125;  // m
  const Finish metal{Material::metal, 21, 0.2F};
  Mesh mesh;
  const auto at = [](double x, float z) { return Vector3f(static_cast<float>(x), 0.0F, z); };
  mesh.addBox(Vector3f::Zero(), Vector3f(0.07F, 0.07F, kHeight + 0.05F), 0.0F, metal);
  mesh.addColumn(at(0.0, kHeight), at(length, kHeight), 0.03F, 0.03F, 8, metal);
  mesh.addColumn(at(0.0, 0.14F), at(length, 0.14F), 0.018F, 0.018F, 6, metal);
  for (const double x : stepsBelow(length - 0.5 * kBarSpacing, kBarSpacing, kBarSpacing))
    mesh.addColumn(at(x, 0.14F), at(x, kHeight), 0.011F, 0.011F, 5, metal);
  return mesh;
}

void addFence(Mesh& mesh, const Eigen::Vector2d& from, const Eigen::Vector2d& to, std::uint32_t seed,
              const Terrain& terrain) {
  Random random(hashOf({seed, 301U}));
  const double length = (to - from).norm();
  const Eigen::Vector2d along = (to - from) / length;
  const auto yaw = static_cast<float>(std::atan2(along.y(), along.x()));
  const auto tone = random.real(0.1, 0.9);
  const auto at = [&](double u, double z) {
    const Eigen::Vector2d p = from + u * along;
    return pointAt(p, terrain.height(p.x(), p.y()) - 0.1 + z);
  };
  for (const double u : stepsBelow(length, 0.0, 0.15)) {
    const auto height = static_cast<float>(1.15 + random.uniform(-0.03, 0.03));
    const float lean = yaw + random.real(-0.06, 0.06);
    mesh.addBox(at(u, 0.08), Vector3f(0.09F, 0.02F, height), lean, {Material::wood, random.bits(), tone});
  }
  for (const double u : stepsBelow(length, 0.0, 2.0)) {
    const double end = std::min(u + 2.0, length);
    mesh.addBox(at(u, -0.2), Vector3f(0.1F, 0.1F, 1.45F), yaw + 0.02F,
                {Material::wood, random.bits(), tone * 0.8F});
    for (const double z : {0.35, 0.95}) {
      const Vector3f side(0.03F * std::sin(yaw), -0.03F * std::cos(yaw), 0.0F);
      const Vector3f up(0, 0, 0.08F);
      const Vector3f a = at(u, z) + side;
      const Vector3f b = at(end, z) + side;
      mesh.addPlane({a, b, b + up, a + up}, {Material::wood, random.bits(), tone});
    }
  }
}

void addGardenWall(Mesh& mesh, const Eigen::Vector2d& from, const Eigen::Vector2d& to, std::uint32_t seed,
                   const Terrain& terrain) {
  const double length = (to - from).norm();
  const Eigen::Vector2d along = (to - from) / length;
  const Eigen::Vector2d across(-along.y(), along.x());
  const float height = 0.7F + 0.7F * unitFloat(hashOf({seed, 302U}));
  const Finish brick{Material::brick, seed, unitFloat(hashOf({seed, 303U}))};
  const Finish stone{Material::concrete, seed, 0.6F};
  const auto at = [&](double u, double w, float z) {
    const Eigen::Vector2d p = from + u * along + w * across;
    const Eigen::Vector2d foot = from + u * along;
    return Vector3f(static_cast<float>(p.x()), static_cast<float>(p.y()),
                    static_cast<float>(terrain.height(foot.x(), foot.y())) + z);
  };
  for (const double u : stepsBelow(length, 0.0, 2.5)) {
    const double end = std::min(u + 2.5, length);
    const auto face = [&](double w0, float z0, double w1, float z1, const Finish& finish) {
      const auto across_length = static_cast<float>(std::hypot(w1 - w0, z1 - z0));
      const auto u0 = static_cast<float>(u);
      const auto u1 = static_cast<float>(end);
      mesh.addQuad({at(u, w0, z0), at(end, w0, z0), at(end, w1, z1), at(u, w1, z1)},
                   Mesh::rectangle(u0, 0.0F, u1, across_length), finish);
    };
    face(-0.12, -0.3F, -0.12, height, brick);
    face(0.12, -0.3F, 0.12, height, brick);
    face(-0.16, height, -0.16, height + 0.08F, stone);
    face(0.16, height, 0.16, height + 0.08F, stone);
    face(-0.16, height + 0.08F, 0.16, height + 0.08F, stone);
    face(-0.16, height, 0.16, height, stone);
  }
}

}  // namespace cartvo::world
