// Builds trees, bushes, tufts and hedges; each leaf (far away: each spray of leaves) is a quadrilateral.
#include "lab/render/scene/vegetation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "lab/render/scene/steps.hpp"
#include "lab/render/surface/hash.hpp"

namespace cartvo::world {
namespace {

using Eigen::Vector3f;

Vector3f randomDirection(Random& random) {
  const double z = random.uniform(-1.0, 1.0);
  const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
  const double r = std::sqrt(1.0 - z * z);
  return Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), z).cast<float>();
}

/// Adds a leaf: a kite along its midrib, random orientation with a preference for facing up.
void addLeaf(Mesh& mesh, const Vector3f& centre, float size, float tone, Random& random) {
  const Vector3f rib = (randomDirection(random) + Vector3f(0, 0, -0.25F)).normalized();
  const Vector3f facing = (randomDirection(random) + Vector3f(0, 0, 0.7F)).normalized();
  const Vector3f side = rib.cross(facing).normalized();
  const Vector3f a = centre - 0.5F * size * rib;
  const Vector3f b = centre + 0.32F * size * side - 0.05F * size * rib;
  const Vector3f c = centre + 0.5F * size * rib;
  const Vector3f d = centre - 0.32F * size * side - 0.05F * size * rib;
  const float w = 0.32F * size;
  mesh.addQuad({a, b, c, d},
               {Eigen::Vector2f(0, -0.5F * size), Eigen::Vector2f(w, 0), Eigen::Vector2f(0, 0.5F * size),
                Eigen::Vector2f(-w, 0)},
               {Material::leaf, random.bits(), tone});
}

/// Adds leaves in the outer part of an ellipsoid; inner leaves are darker.
void addFoliage(Mesh& mesh, const Vector3f& centre, const Vector3f& radii, int leaves, float leaf_size,
                Random& random) {
  for (int i = 0; i < leaves; ++i) {
    const auto depth = static_cast<float>(std::pow(random.uniform(0.05, 1.0), 0.45));
    const Vector3f place = centre + depth * radii.cwiseProduct(randomDirection(random));
    const auto size = static_cast<float>(leaf_size * random.uniform(0.7, 1.3));
    addLeaf(mesh, place, size, 0.15F + 0.7F * depth, random);
  }
}

/// Adds a hedge whose place `u` m along it, `w` m across it and `z` m above its foot is place(u, w, z).
template <typename Place>
void addHedge(Mesh& mesh, double length, double height, const Place& place, Random& random) {
  const double half_width = 0.4;
  for (const double u : stepsBelow(length, 0.0, 1.5)) {  // dark core that follows the ground
    const double end = std::min(u + 1.5, length);
    const Finish core{Material::leaf, 7U, 0.0F};
    const double w = half_width - 0.12;
    const double h = height - 0.12;
    mesh.addPlane({place(u, -w, 0), place(end, -w, 0), place(end, -w, h), place(u, -w, h)}, core);
    mesh.addPlane({place(u, w, 0), place(end, w, 0), place(end, w, h), place(u, w, h)}, core);
    mesh.addPlane({place(u, -w, h), place(end, -w, h), place(end, w, h), place(u, w, h)}, core);
  }
  const int leaves = static_cast<int>(length * (2.0 * height + 2.0 * half_width) * 190.0);
  for (int i = 0; i < leaves; ++i) {
    const double around = random.uniform(0.0, 2.0 * height + 2.0 * half_width);
    const double u = random.uniform(0.0, length);
    const double shell = random.uniform(-0.12, 0.05);
    const auto tone = static_cast<float>(0.45 + 3.0 * shell + random.uniform(-0.1, 0.1));
    Vector3f centre;
    if (around < height) {
      centre = place(u, -half_width - shell, around);
    } else if (around < 2.0 * height) {
      centre = place(u, half_width + shell, around - height);
    } else {
      centre = place(u, around - 2.0 * height - half_width, height + shell);
    }
    addLeaf(mesh, centre, random.real(0.07, 0.13), tone, random);
  }
}

}  // namespace

Mesh makeTree(std::uint32_t seed, Detail detail) {
  const bool near = detail == Detail::leaves;
  const float leaf_size = near ? 0.21F : 0.38F;
  const float density = near ? 1.0F : 0.27F;
  Mesh mesh;
  Random random(hashOf({seed, 201U}));
  const auto trunk_height = random.real(2.2, 3.2);
  const auto crown_height = random.real(4.0, 5.5);
  const auto crown_radius = random.real(1.9, 2.9);
  const Finish bark{Material::bark, random.bits(), 0.5F};
  const Vector3f lean(random.real(-0.25, 0.25), random.real(-0.25, 0.25), trunk_height);
  mesh.addColumn(Vector3f(0, 0, -0.2F), Vector3f(0, 0, 0.25F), 0.30F, 0.19F, 10, bark);
  mesh.addColumn(Vector3f(0, 0, 0.25F), lean, 0.19F, 0.14F, 10, bark);
  const Vector3f top = lean + Vector3f(0, 0, 0.75F * crown_height);
  mesh.addColumn(lean, top, 0.14F, 0.04F, 7, bark);
  const int boughs = 11 + random.below(5);
  for (int i = 0; i < boughs; ++i) {
    const auto share = static_cast<float>((i + 0.5) / boughs);
    const auto angle = static_cast<float>(i * 2.4 + random.uniform(-0.4, 0.4));  // about the golden angle
    const float reach =
        crown_radius * (0.35F + 0.65F * std::sin(std::numbers::pi_v<float> * (0.15F + 0.75F * share)));
    const Vector3f root = lean + share * (top - lean);
    const Vector3f tip = root + Vector3f(std::cos(angle) * reach * 0.75F, std::sin(angle) * reach * 0.75F,
                                         0.3F * reach + 0.2F);
    mesh.addColumn(root, tip, 0.06F, 0.015F, 5, bark);
    const float ball = reach * random.real(0.45, 0.62);
    addFoliage(mesh, tip, Vector3f(ball, ball, 0.72F * ball),
               static_cast<int>(density * (230.0F * ball * ball + 120.0F)), leaf_size, random);
  }
  return mesh;
}

Mesh makeBush(std::uint32_t seed) {
  Mesh mesh;
  Random random(hashOf({seed, 202U}));
  for (int i = 0; i < 5; ++i) {
    const Vector3f centre(random.real(-0.45, 0.45), random.real(-0.45, 0.45), random.real(0.35, 0.7));
    mesh.addColumn(Vector3f::Zero(), centre, 0.025F, 0.01F, 4, {Material::bark, random.bits(), 0.5F});
    addFoliage(mesh, centre, Vector3f(0.5F, 0.5F, 0.42F), 330, 0.11F, random);
  }
  return mesh;
}

Mesh makeTuft(std::uint32_t seed) {
  Mesh mesh;
  Random random(hashOf({seed, 203U}));
  for (int i = 0; i < 70; ++i) {
    const Vector3f root(random.real(-0.22, 0.22), random.real(-0.22, 0.22), -0.03F);
    const Vector3f blade =
        Vector3f(random.real(-0.14, 0.14), random.real(-0.14, 0.14), random.real(0.12, 0.38));
    const Vector3f side = 0.009F * blade.cross(randomDirection(random)).normalized();
    mesh.addPlane({root - side, root + side, root + blade, root + blade},
                  {Material::leaf, random.bits(), random.real(0.4, 1.0)});
  }
  return mesh;
}

void addHedge(Mesh& mesh, const Eigen::Vector2d& from, const Eigen::Vector2d& to, std::uint32_t seed,
              const Terrain& terrain) {
  Random random(hashOf({seed, 204U}));
  const double length = (to - from).norm();
  const double height = random.uniform(0.9, 1.5);
  const Eigen::Vector2d along = (to - from) / length;
  const Eigen::Vector2d across(-along.y(), along.x());
  const auto place = [&](double u, double w, double z) {
    const Eigen::Vector2d p = from + u * along + w * across;
    return pointAt(p, terrain.height(p.x(), p.y()) - 0.1 + z);
  };
  addHedge(mesh, length, height, place, random);
}

Mesh makeHedgePiece(std::uint32_t seed, double length, double height) {
  Mesh mesh;
  Random random(hashOf({seed, 205U}));
  const auto place = [](double u, double w, double z) { return pointAt({u, w}, z); };
  addHedge(mesh, length, height, place, random);
  return mesh;
}

Mesh makeBlownLeaves(std::uint32_t seed) {
  constexpr int kLeaves = 45;
  Mesh mesh;
  Random random(hashOf({seed, 206U}));
  for (int i = 0; i < kLeaves; ++i) {
    const auto x = random.real(-1.0, 1.0);
    const auto y = random.real(-1.0, 1.0);
    const auto z = static_cast<float>(0.03 + 0.5 * std::pow(random.uniform(0.0, 1.0), 3.0));
    addLeaf(mesh, {x, y, z}, random.real(0.06, 0.12), random.real(0.3, 1.0), random);
  }
  return mesh;
}

}  // namespace cartvo::world
