// Builds the meshes of vehicles from their side outlines.
#include "lab/render/scene/vehicle.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace cartvo::world {
namespace {

using Eigen::Vector3f;

/// A point of the body's side outline, in order from rear to front over the top, m.
struct Station {
  float x, z;
  float half_width;
  bool glass;  ///< whether the strip from this station to the next is glass
};

struct Shape {
  std::vector<Station> outline;
  float sill;  ///< height of the underside, m
  float wheelbase, wheel_radius, half_width;
  float waist;  ///< height of the side windows' lower edge, m
};

/// In the order of the enumeration.
const std::array<Shape, kVehicleKinds> kShapes{{
    {{{-0.72F, 0.35F, 0.84F, false},
      {-0.76F, 0.85F, 0.86F, true},
      {-0.38F, 1.42F, 0.64F, false},
      {0.45F, 1.50F, 0.66F, false},
      {1.30F, 1.44F, 0.66F, true},
      {2.10F, 0.98F, 0.80F, false},
      {2.95F, 0.80F, 0.80F, false},
      {3.22F, 0.62F, 0.78F, false},
      {3.26F, 0.30F, 0.76F, false}},
     0.25F,
     2.45F,
     0.30F,
     0.86F,
     0.92F},
    {{{-1.02F, 0.36F, 0.84F, false},
      {-1.06F, 0.92F, 0.84F, false},
      {-0.42F, 0.99F, 0.82F, true},
      {0.22F, 1.40F, 0.62F, false},
      {0.80F, 1.45F, 0.64F, false},
      {1.42F, 1.40F, 0.64F, true},
      {2.25F, 0.97F, 0.82F, false},
      {3.20F, 0.82F, 0.82F, false},
      {3.52F, 0.62F, 0.80F, false},
      {3.56F, 0.30F, 0.78F, false}},
     0.24F,
     2.72F,
     0.32F,
     0.89F,
     0.95F},
    {{{-0.95F, 0.40F, 0.94F, false},
      {-0.98F, 1.30F, 0.95F, true},
      {-0.96F, 1.95F, 0.90F, false},
      {-0.88F, 2.28F, 0.84F, false},
      {2.30F, 2.32F, 0.84F, false},
      {2.75F, 2.10F, 0.84F, true},
      {3.55F, 1.28F, 0.92F, false},
      {4.15F, 1.02F, 0.92F, false},
      {4.32F, 0.35F, 0.90F, false}},
     0.32F,
     3.35F,
     0.34F,
     0.98F,
     1.28F},
    {{{-2.30F, 0.40F, 1.20F, false},
      {-2.34F, 1.40F, 1.22F, true},
      {-2.32F, 2.50F, 1.20F, false},
      {-2.20F, 2.95F, 1.12F, false},
      {6.20F, 2.98F, 1.12F, false},
      {6.45F, 2.75F, 1.18F, true},
      {6.62F, 1.15F, 1.22F, false},
      {6.66F, 0.40F, 1.20F, false}},
     0.34F,
     4.40F,
     0.46F,
     1.24F,
     1.30F},
}};

const Shape& shapeOf(VehicleKind kind) {
  return kShapes.at(static_cast<std::size_t>(kind));
}

void addSides(Mesh& mesh, const Shape& shape, float side) {
  const Finish paint{Material::paint, 1, 0.5F};
  const Finish glass{Material::glass, 2, 0.5F};
  // The flank below the waist, in pieces from the sill to the outline.
  const auto& line = shape.outline;
  const auto flank = [&](float x, float z) { return Vector3f(x, side * shape.half_width, z); };
  for (std::size_t i = 1; i + 2 < line.size(); ++i) {
    const Station& a = line[i];
    const Station& b = line[i + 1];
    const float za = std::min(a.z, shape.waist);
    const float zb = std::min(b.z, shape.waist);
    mesh.addQuad({flank(a.x, shape.sill), flank(b.x, shape.sill), flank(b.x, zb), flank(a.x, za)},
                 {Eigen::Vector2f(a.x, shape.sill), Eigen::Vector2f(b.x, shape.sill),
                  Eigen::Vector2f(b.x, zb), Eigen::Vector2f(a.x, za)},
                 paint);
    if (a.z <= shape.waist && b.z <= shape.waist) continue;
    // Above the waist: inclined to the roof, with windows between posts.
    const Vector3f top_a(a.x, side * a.half_width, a.z);
    const Vector3f top_b(b.x, side * b.half_width, b.z);
    const Vector3f low_a = flank(a.x, za);
    const Vector3f low_b = flank(b.x, zb);
    const auto between = [&](float s, float t) -> Vector3f {
      return (1 - t) * ((1 - s) * low_a + s * low_b) + t * ((1 - s) * top_a + s * top_b);
    };
    mesh.addPlane({low_a, low_b, top_b, top_a}, paint);
    const int panes = std::max(1, static_cast<int>((b.x - a.x) / 1.3F));
    for (int p = 0; p < panes; ++p) {  // 12 mm outside the body
      const float s0 = (static_cast<float>(p) + 0.06F) / static_cast<float>(panes);
      const float s1 = (static_cast<float>(p) + 0.94F) / static_cast<float>(panes);
      const Vector3f out(0.0F, side * 0.012F, 0.004F);
      mesh.addPlane({between(s0, 0.1F) + out, between(s1, 0.1F) + out, between(s1, 0.82F) + out,
                     between(s0, 0.82F) + out},
                    glass);
    }
  }
}

void addWheel(Mesh& mesh, const Vector3f& centre, float radius, float side) {
  const Finish tyre{Material::rubber, 3, 0.5F};
  const Finish rim{Material::metal, 4, 0.6F};
  const Vector3f half(0.0F, side * 0.11F, 0.0F);
  constexpr int kSides = 14;
  mesh.addColumn(centre - half, centre + half, radius, radius, kSides, tyre);
  const auto ring = [&](int i, float r) -> Vector3f {
    const float angle = 2.0F * std::numbers::pi_v<float> * static_cast<float>(i) / kSides;
    return centre + half + Vector3f(r * std::cos(angle), 0.0F, r * std::sin(angle));
  };
  for (int i = 0; i < kSides; ++i) {
    mesh.addPlane({ring(i, radius), ring(i + 1, radius), ring(i + 1, 0.6F * radius), ring(i, 0.6F * radius)},
                  tyre);
    const float inner = (i % 2 == 0) ? 0.0F : 0.12F * radius;
    mesh.addPlane({ring(i, 0.6F * radius), ring(i + 1, 0.6F * radius), ring(i + 1, inner), ring(i, inner)},
                  (i % 3 == 0) ? tyre : rim);
  }
}

}  // namespace

double vehicleWheelbase(VehicleKind kind) {
  return shapeOf(kind).wheelbase;
}

Mesh makeVehicle(VehicleKind kind) {
  Mesh mesh;
  const Shape& shape = shapeOf(kind);
  const Finish paint{Material::paint, 1, 0.5F};
  const Finish glass{Material::glass, 2, 0.5F};
  const auto& line = shape.outline;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Station& a = line[i];
    const Station& b = line[i + 1];
    const auto at = [](const Station& s, float share) { return Vector3f(s.x, share * s.half_width, s.z); };
    mesh.addPlane({at(a, -1.0F), at(a, 1.0F), at(b, 1.0F), at(b, -1.0F)}, paint);
    if (!a.glass) continue;
    const Vector3f across = b.x > a.x ? Vector3f(a.z - b.z, 0.0F, b.x - a.x) : Vector3f(-1.0F, 0.0F, 0.0F);
    const Vector3f out = 0.012F * across.normalized();
    const Vector3f rise = 0.08F * (at(b, 0.0F) - at(a, 0.0F));
    mesh.addPlane({at(a, -0.88F) + rise + out, at(a, 0.88F) + rise + out, at(b, 0.88F) - rise + out,
                   at(b, -0.88F) - rise + out},
                  glass);
  }
  for (const float side : {-1.0F, 1.0F}) {
    addSides(mesh, shape, side);
    for (const float x : {0.0F, shape.wheelbase}) {
      addWheel(mesh, Vector3f(x, side * (shape.half_width - 0.06F), shape.wheel_radius), shape.wheel_radius,
               side);
    }
    // Lamps: front bright, rear dark.
    const Station& rear = line[1];
    const Station& front = line[line.size() - 2];
    mesh.addBox(Vector3f(front.x, side * 0.68F * front.half_width, front.z - 0.12F),
                Vector3f(0.12F, 0.3F, 0.14F), 0.0F, {Material::metal, 5, 1.0F});
    mesh.addBox(Vector3f(rear.x + 0.02F, side * 0.82F * rear.half_width, rear.z - 0.28F),
                Vector3f(0.08F, 0.16F, 0.24F), 0.0F, {Material::rubber, 6, 1.0F});
  }
  mesh.addBox(Vector3f(line[0].x - 0.02F, 0.0F, 0.5F), Vector3f(0.04F, 0.5F, 0.11F), 0.0F,
              {Material::sign, 7, 0.5F});
  const float x0 = line.front().x;
  const float x1 = line.back().x;
  const float w = shape.half_width;
  mesh.addPlane({Vector3f(x0, -w, shape.sill), Vector3f(x1, -w, shape.sill), Vector3f(x1, w, shape.sill),
                 Vector3f(x0, w, shape.sill)},
                {Material::rubber, 8, 0.5F});
  return mesh;
}

}  // namespace cartvo::world
