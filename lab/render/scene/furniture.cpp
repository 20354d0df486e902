// Builds the meshes of street furniture, fences, garden walls and the garage.
#include "lab/render/scene/furniture.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "lab/render/scene/steps.hpp"
#include "lab/render/scene/vehicle.hpp"
#include "lab/render/surface/hash.hpp"

namespace cartvo::world {

using Eigen::Vector3f;
namespace {

using Eigen::Vector2d;
using Eigen::Vector3f;

constexpr double kGrid = 5.0;           // m between columns and between beams
constexpr double kBayWidth = 2.5;       // m
constexpr double kBayDepth = 5.2;       // m
constexpr double kAisle = 3.1;          // m from the path to the bays
constexpr float kCeiling = 2.65F;       // m above the floor; the cameras are 1.9 m above it
constexpr float kBeamDepth = 0.35F;     // m, also the width
constexpr float kColumn = 0.4F;         // m, width
constexpr double kClearance = 2.2;      // m from the path to a column's middle
constexpr float kPaintHeight = 4e-3F;   // m above the floor
constexpr std::uint32_t kSeed = 9101U;  // of its finishes

/// Collects the parts of a garage.
class GarageBuilder {
 public:
  GarageBuilder(Campus& campus, const Path& path, std::uint64_t seed)
      : campus_(campus), path_(path), random_(hashOf({static_cast<std::uint32_t>(seed), 901U})) {
    for (const double s : stepsBelow(path.length(), 0.0, 0.5))
      bounds_.extend(path.at(s).position);
    const Vector2d margin = Vector2d::Constant(kAisle + kBayDepth + 0.3);
    bounds_ = Eigen::AlignedBox2d(bounds_.min() - margin, bounds_.max() + margin);
    for (std::uint32_t kind = 0; kind < 3; ++kind)
      cars_[kind] = campus.addMesh(makeVehicle(static_cast<VehicleKind>(kind)));
  }

  void addShell() {
    addLevel(0.0F, {Material::concrete, kSeed, 0.2F});
    addLevel(kCeiling, {Material::concrete, kSeed + 1, 0.7F});
    const std::array<Vector2d, 4> at = corners();
    for (std::size_t i = 0; i < 4; ++i) {
      const Vector2d& from = at[i];
      const Vector2d& to = at[(i + 1) % 4];
      fixed().addPlane({pointAt(from, 0.0), pointAt(to, 0.0), pointAt(to, kCeiling), pointAt(from, kCeiling)},
                       {Material::concrete, kSeed + 2, 0.5F});
    }
  }
  void addBeamsAndColumns() {
    const Finish beam{Material::concrete, kSeed + 3, 0.6F};
    const Finish column{Material::concrete, kSeed + 4, 0.8F};
    const Finish warning{Material::paint, kSeed + 5, 0.15F};
    const double width = bounds_.sizes().y();
    for (const double x :
         stepsBelow(bounds_.max().x(), kGrid * std::ceil(bounds_.min().x() / kGrid), kGrid)) {
      const Vector3f middle = pointAt({x, bounds_.center().y()}, kCeiling - kBeamDepth);
      fixed().addBox(middle, Vector3f(kBeamDepth, static_cast<float>(width), kBeamDepth), 0.0F, beam);
      for (const double y :
           stepsBelow(bounds_.max().y(), kGrid * std::ceil(bounds_.min().y() / kGrid), kGrid)) {
        const Vector2d place(x + 0.5 * kBayWidth, y + 0.3 * kGrid);
        if (distanceToPath(place) < kClearance) continue;
        const Vector3f foot = pointAt(place, 0.0);
        fixed().addBox(foot, Vector3f(kColumn, kColumn, kCeiling), 0.0F, column);
        fixed().addBox(foot, Vector3f(kColumn + 0.01F, kColumn + 0.01F, 0.9F), 0.0F, warning);
      }
    }
  }
  void addBays() {
    for (const double s : stepsBelow(path_.length(), 0.0, kBayWidth)) {
      const PathPoint p = path_.at(s);
      const double yaw = std::atan2(p.tangent.y(), p.tangent.x());
      if (std::abs(p.curvature) > 0.03) continue;
      for (const double side : {1.0, -1.0}) {
        for (const double depth : {0.0, kBayDepth}) {  // a second row behind the first one, except at walls
          const Vector2d mouth = p.beside(side * (kAisle + depth));
          const Vector2d end = p.beside(side * (kAisle + depth + kBayDepth));
          if (distanceToPath(mouth) < kAisle - 0.1 || distanceToPath(end) < kAisle + 1.0 ||
              !bounds_.contains(end))
            continue;
          addBay(mouth, yaw + side * 0.5 * std::numbers::pi);
        }
      }
    }
  }

 private:
  Mesh& fixed() { return campus_.meshes.front(); }
  double distanceToPath(const Vector2d& at) const {
    double nearest = 1e9;
    for (const double s : stepsBelow(path_.length(), 0.0, 0.5))
      nearest = std::min(nearest, (at - path_.at(s).position).norm());
    return nearest;
  }
  std::array<Vector2d, 4> corners() const {
    const Vector2d a = bounds_.min(), b = bounds_.max();
    return {a, Vector2d(b.x(), a.y()), b, Vector2d(a.x(), b.y())};
  }
  /// A level plane over the whole garage.
  void addLevel(float z, const Finish& finish) {
    const std::array<Vector2d, 4> at = corners();
    fixed().addPlane({pointAt(at[0], z), pointAt(at[1], z), pointAt(at[2], z), pointAt(at[3], z)}, finish);
  }
  /// Adds the painted line on one side of a bay and, in most bays, a car. `yaw`: the direction into the bay.
  void addBay(const Vector2d& mouth, double yaw) {
    const Vector2d inward(std::cos(yaw), std::sin(yaw));
    const Vector2d across(-inward.y(), inward.x());
    const Vector2d line = mouth + 0.5 * kBayWidth * across;
    const auto corner = [&](double depth, double side) {
      return pointAt(line + depth * inward + side * across, kPaintHeight);
    };
    fixed().addPlane(
        {corner(0.0, -0.06), corner(kBayDepth, -0.06), corner(kBayDepth, 0.06), corner(0.0, 0.06)},
        {Material::paint, kSeed + 6, 0.9F});
    if (random_.chance(0.7)) addCar(mouth, yaw);
  }
  void addCar(const Vector2d& mouth, double yaw) {
    const int kind = random_.chance(0.15) ? 2 : random_.below(2);
    const double wheelbase = vehicleWheelbase(static_cast<VehicleKind>(kind));
    const bool reversed = random_.chance(0.4);
    const Vector2d inward(std::cos(yaw), std::sin(yaw));
    const Vector2d middle = mouth + (0.52 * kBayDepth + random_.uniform(-0.2, 0.2)) * inward;
    const Eigen::Isometry3d pose =
        Eigen::Translation3d(middle.x(), middle.y(), 0.0) *
        Eigen::AngleAxisd(yaw + (reversed ? std::numbers::pi : 0.0) + random_.uniform(-0.03, 0.03),
                          Eigen::Vector3d::UnitZ()) *
        Eigen::Translation3d(-0.5 * wheelbase, 0.0, 0.0);
    campus_.instances.push_back(paintedInstance(cars_[static_cast<std::size_t>(kind)], random_));
    campus_.instances.back().placement = toAffine(pose);
  }

  Campus& campus_;
  const Path& path_;
  Random random_;
  Eigen::AlignedBox2d bounds_;
  std::array<std::uint32_t, 3> cars_{};
};

}  // namespace

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

void addGarage(Campus& campus, const Path& path, std::uint64_t seed) {
  GarageBuilder garage(campus, path, seed);
  garage.addShell();
  garage.addBeamsAndColumns();
  garage.addBays();
}

}  // namespace cartvo::world
