// Builds a parking garage on a grid of 5 m.
#include "lab/render/scene/garage.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "lab/render/scene/steps.hpp"
#include "lab/render/scene/vehicle.hpp"
#include "lab/render/surface/hash.hpp"

namespace cartvo::world {
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

  void addShell();
  void addBeamsAndColumns();
  void addBays();

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
  void addLevel(float z, const Finish& finish);
  void addBay(const Vector2d& mouth, double yaw);
  void addCar(const Vector2d& mouth, double yaw);

  Campus& campus_;
  const Path& path_;
  Random random_;
  Eigen::AlignedBox2d bounds_;
  std::array<std::uint32_t, 3> cars_{};
};

/// A level plane over the whole garage.
void GarageBuilder::addLevel(float z, const Finish& finish) {
  const std::array<Vector2d, 4> at = corners();
  fixed().addPlane({pointAt(at[0], z), pointAt(at[1], z), pointAt(at[2], z), pointAt(at[3], z)}, finish);
}

void GarageBuilder::addShell() {
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

void GarageBuilder::addBeamsAndColumns() {
  const Finish beam{Material::concrete, kSeed + 3, 0.6F};
  const Finish column{Material::concrete, kSeed + 4, 0.8F};
  const Finish warning{Material::paint, kSeed + 5, 0.15F};
  const double width = bounds_.sizes().y();
  for (const double x : stepsBelow(bounds_.max().x(), kGrid * std::ceil(bounds_.min().x() / kGrid), kGrid)) {
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

void GarageBuilder::addCar(const Vector2d& mouth, double yaw) {
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

/// Adds the painted line on one side of a bay and, in most bays, a car. `yaw`: the direction into the bay.
void GarageBuilder::addBay(const Vector2d& mouth, double yaw) {
  const Vector2d inward(std::cos(yaw), std::sin(yaw));
  const Vector2d across(-inward.y(), inward.x());
  const Vector2d line = mouth + 0.5 * kBayWidth * across;
  const auto corner = [&](double depth, double side) {
    return pointAt(line + depth * inward + side * across, kPaintHeight);
  };
  fixed().addPlane({corner(0.0, -0.06), corner(kBayDepth, -0.06), corner(kBayDepth, 0.06), corner(0.0, 0.06)},
                   {Material::paint, kSeed + 6, 0.9F});
  if (random_.chance(0.7)) addCar(mouth, yaw);
}

void GarageBuilder::addBays() {
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

}  // namespace

void addGarage(Campus& campus, const Path& path, std::uint64_t seed) {
  GarageBuilder garage(campus, path, seed);
  garage.addShell();
  garage.addBeamsAndColumns();
  garage.addBays();
}

}  // namespace cartvo::world
