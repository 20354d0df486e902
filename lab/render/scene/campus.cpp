// Lays out the campus: objects along the road by arc length, others at random positions, without collisions.
#include "lab/render/scene/campus.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lab/render/scenario_traits.hpp"
#include "lab/render/scene/furniture.hpp"
#include "lab/render/scene/steps.hpp"
#include "lab/render/scene/underpass.hpp"
#include "lab/render/scene/vegetation.hpp"
#include "lab/render/scene/vehicle.hpp"
#include "lab/render/surface/hash.hpp"

namespace cartvo::world {
namespace {

using Eigen::Vector2d;

constexpr double kLeafDetailRange = 28.0;  // m from the path; farther trees use sprays of leaves
constexpr double kOpenClearance = 45.0;    // m from the path; open land has no objects nearer
constexpr float kTreeSway = 0.03F;         // see Instance::sway
constexpr float kBushSway = 0.15F;

/// Adds objects to a campus and keeps the ground plans of its buildings to avoid collisions.
class Layout {
 public:
  Layout(const Path& path, const WorldSettings& settings, Campus& campus)
      : path_(path),
        campus_(campus),
        random_(hashOf({static_cast<std::uint32_t>(settings.seed), 101U})),
        traits_(traitsOf(settings.scenario)) {
    for (const double s : stepsBelow(path.length(), 0.0, 2.0))
      samples_.push_back(path.at(s));
  }

  void addUnderpasses(const std::vector<Underpass>& underpasses) {
    for (const Underpass& underpass : underpasses) {
      addUnderpass(fixed(), underpass, path_, traits_.terrain);
      buildings_.push_back(groundPlan(underpass));
    }
  }
  void addBuildings() {
    if (!traits_.houses) return;
    for (const double s : stepsBelow(path_.length(), 0.0, 3.0)) {
      for (const double side : {1.0, -1.0}) {
        if (random_.chance(traits_.sparse ? 0.75 : 0.35)) continue;
        const PathPoint p = path_.at(s);
        const double border = side > 0.0 ? campus_.road.leftBorder() : -campus_.road.rightBorder();
        const double setback = border + random_.uniform(2.2, 9.0) + 6.0;
        const double yaw = std::atan2(p.tangent.y(), p.tangent.x());
        tryBuilding(p.beside(side * setback), yaw + random_.uniform(-0.06, 0.06), 3);
      }
    }
    for (int i = 0; i < (traits_.sparse ? 60 : 260); ++i) {
      tryBuilding(randomPosition(75.0), random_.uniform(0.0, std::numbers::pi), 6);
    }
  }
  void addBorders() {
    if (traits_.sparse || traits_.lining != Lining::none) return;
    for (const double side : {1.0, -1.0}) {
      double s = random_.uniform(0.0, 8.0);
      while (s < path_.length() - 20.0) {
        const double length = random_.uniform(6.0, 15.0);
        const double border = side > 0.0 ? campus_.road.leftBorder() : campus_.road.rightBorder();
        const double lateral = border + side * random_.uniform(0.5, 1.1);
        const PathPoint a = path_.at(s);
        const PathPoint b = path_.at(s + length);
        s += length + random_.uniform(0.5, 7.0);
        // Borders are straight: skip bends.
        if (a.tangent.dot(b.tangent) < 0.995) continue;
        const Vector2d from = a.beside(lateral);
        const Vector2d to = b.beside(lateral);
        const Vector2d middle = 0.5 * (from + to);
        if (!clearOfBuildings(from, 0.6) || !clearOfBuildings(middle, 0.6) || !clearOfBuildings(to, 0.6))
          continue;
        const double kind = random_.uniform(0.0, 1.0);
        if (kind < 0.35) {
          addFence(fixed(), from, to, random_.bits(), traits_.terrain);
        } else if (kind < 0.68) {
          addHedge(fixed(), from, to, random_.bits(), traits_.terrain);
        } else {
          addGardenWall(fixed(), from, to, random_.bits(), traits_.terrain);
        }
      }
    }
  }
  /// Lines both borders of the road with equal pieces. Hedges come in few variants; railings are all the
  /// same.
  void addLining() {
    constexpr double kPieceLength = 2.0;  // m
    constexpr int kHedges = 3;
    if (traits_.lining == Lining::none) return;
    const bool hedge = traits_.lining == Lining::hedge;
    std::vector<std::uint32_t> pieces;
    for (int i = 0; i < (hedge ? kHedges : 1); ++i) {
      pieces.push_back(addMesh(hedge ? makeHedgePiece(random_.bits(), kPieceLength, 2.1)
                                     : makeRailingPiece(kPieceLength)));
    }
    const double beyond_border = hedge ? 0.6 : -0.1;
    const double spacing = hedge ? 0.75 * kPieceLength : kPieceLength;  // hedges overlap, in bends too
    for (const double s : stepsBelow(path_.length(), 0.0, spacing)) {
      const PathPoint p = path_.at(s);
      for (const double lateral :
           {campus_.road.leftBorder() + beyond_border, campus_.road.rightBorder() - beyond_border}) {
        Instance piece;
        piece.mesh = pieces[static_cast<std::size_t>(random_.below(static_cast<int>(pieces.size())))];
        piece.placement = toAffine(groundPose(traits_.terrain, p, clampWithinBend(p, lateral), kPieceLength));
        campus_.instances.push_back(piece);
      }
    }
  }
  /// Plants trees at equal distances along both borders of the road.
  void addAvenue() {
    constexpr double kSpacing = 6.5;  // m
    if (!traits_.avenue) return;
    std::vector<std::uint32_t> trees;
    for (int i = 0; i < 4; ++i)
      trees.push_back(addMesh(makeTree(random_.bits(), Detail::leaves)));
    for (const double s : stepsBelow(path_.length(), 0.0, kSpacing)) {
      const PathPoint p = path_.at(s);
      for (const double lateral : {campus_.road.leftBorder() + 0.8, campus_.road.rightBorder() - 0.8}) {
        place(trees[static_cast<std::size_t>(random_.below(4))], p.beside(lateral),
              random_.uniform(0.0, 6.28), random_.uniform(0.95, 1.1));
        if (traits_.wind) campus_.instances.back().sway = kTreeSway;
      }
    }
  }
  void addTrees() {
    constexpr int kKinds = 6;
    std::vector<std::uint32_t> near_trees, far_trees, swaying_bushes;
    std::vector<Mesh> bushes, tufts;
    for (int i = 0; i < kKinds; ++i) {
      const std::uint32_t seed = random_.bits();
      near_trees.push_back(addMesh(makeTree(seed, Detail::leaves)));
      far_trees.push_back(addMesh(makeTree(seed, Detail::sprays)));
      bushes.push_back(makeBush(random_.bits()));
      tufts.push_back(makeTuft(random_.bits()));
      if (traits_.wind) swaying_bushes.push_back(addMesh(bushes.back()));
    }
    const auto has_room = [&](const Vector2d& at, double room) {
      return clearOfRoad(at, 0.4) && clearOfBuildings(at, room);
    };
    const auto plant_tree = [&](const Vector2d& at, double from, double to) {
      if (!has_room(at, 2.3)) return;
      const bool near = distanceToPath(at) < kLeafDetailRange;
      place((near ? near_trees : far_trees)[random_.below(kKinds)], at, random_.uniform(0.0, 6.28),
            random_.uniform(from, to));
      if (traits_.wind && near) campus_.instances.back().sway = kTreeSway;
    };
    const auto plant_small = [&](const std::vector<Mesh>& kinds, const Vector2d& at, double room, double from,
                                 double to) {
      if (!has_room(at, room)) return;
      const auto scale = random_.real(from, to);
      fixed().addMesh(kinds[random_.below(kKinds)],
                      placementOnGround(at, random_.uniform(0.0, 6.28)) * Eigen::Scaling(scale),
                      random_.bits());
    };
    const auto plant_bush = [&](const Vector2d& at) {
      if (!traits_.wind) return plant_small(bushes, at, 0.9, 0.5, 1.3);
      if (!has_room(at, 0.9)) return;
      place(swaying_bushes[static_cast<std::size_t>(random_.below(kKinds))], at, random_.uniform(0.0, 6.28),
            random_.uniform(0.5, 1.3));
      campus_.instances.back().sway = kBushSway;
    };
    const double density = traits_.sparse ? 0.12 : 1.0;
    for (const double s : stepsBelow(path_.length(), 0.0, 1.0)) {
      for (const double side : {1.0, -1.0}) {
        const PathPoint p = path_.at(s + random_.uniform(-0.5, 0.5));
        const double border = side > 0.0 ? campus_.road.leftBorder() : campus_.road.rightBorder();
        const auto off = [&](double from, double to) {
          return p.beside(border + side * random_.uniform(from, to));
        };
        if (random_.chance(0.075 * density)) plant_tree(off(1.4, 5.5), 0.65, 1.2);
        if (random_.chance(0.12 * density)) plant_bush(off(1.0, 5.0));
        if (random_.chance(0.9 * density)) plant_small(tufts, off(0.15, 2.4), 0.3, 0.5, 1.3);
      }
    }
    for (int i = 0; i < static_cast<int>(170 * density); ++i)
      plant_tree(randomPosition(60.0), 0.8, 1.5);
    for (int i = 0; i < 240; ++i) {  // a belt of trees around the campus
      const double angle = random_.uniform(0.0, 2.0 * std::numbers::pi);
      const double radius = random_.uniform(170.0, 230.0);
      plant_tree(traits_.open ? randomPosition(120.0)
                              : Vector2d(45.0 + radius * std::cos(angle), -45.0 + radius * std::sin(angle)),
                 1.0, 1.9);
    }
  }
  void addStreetFurniture() {
    if (traits_.sparse || traits_.lining != Lining::none) return;
    const std::uint32_t lamp = addMesh(makeLampPost());
    const std::uint32_t bollard = addMesh(makeBollard());
    const std::uint32_t bench = addMesh(makeBench());
    const std::uint32_t bin = addMesh(makeBin());
    std::vector<std::uint32_t> signs;
    signs.reserve(5);
    for (int i = 0; i < 5; ++i)
      signs.push_back(addMesh(makeSign(random_.bits())));
    for (const double s : stepsBelow(path_.length(), 4.0, 2.5)) {
      for (const double side : {1.0, -1.0}) {
        const PathPoint p = path_.at(s + random_.uniform(-0.8, 0.8));
        const double kerb = side > 0.0 ? campus_.road.left_kerb : campus_.road.right_kerb;
        const double inner = side > 0.0 ? campus_.road.leftBorder() : campus_.road.rightBorder();
        const Vector2d at = p.beside(clampWithinBend(p, kerb + side * 0.4));
        const Vector2d behind = p.beside(clampWithinBend(p, inner - side * 0.35));
        if (!clearOfBuildings(at, 0.5)) continue;  // inside an underpass
        const double toward = std::atan2(p.tangent.y(), p.tangent.x()) - side * 0.5 * std::numbers::pi;
        const double kind = random_.uniform(0.0, 1.0);
        if (kind < 0.09) place(lamp, at, toward, 1.0);
        if (kind > 0.09 && kind < 0.17) place(bollard, at, 0.0, random_.uniform(0.9, 1.1));
        if (kind > 0.17 && kind < 0.24) {
          place(signs[random_.below(5)], at,
                toward - side * 0.5 * std::numbers::pi + random_.uniform(-0.3, 0.3), 1.0);
        }
        if (kind > 0.24 && kind < 0.28) place(bench, behind, toward + 0.5 * std::numbers::pi, 1.0);
        if (kind > 0.28 && kind < 0.33) place(bin, behind, 0.0, random_.uniform(0.9, 1.05));
      }
    }
  }
  void addParkedCars() {
    if (traits_.sparse || campus_.road.left_kerb < 7.0) return;
    std::vector<std::uint32_t> kinds;
    kinds.reserve(3);
    for (int i = 0; i < 3; ++i)
      kinds.push_back(addMesh(makeVehicle(static_cast<VehicleKind>(i))));
    double s = 6.0;
    while (s < path_.length() - 8.0) {
      const PathPoint p = path_.at(s);
      s += random_.uniform(6.4, 9.0);
      if (random_.chance(0.4) || std::abs(p.curvature) > 0.02) continue;
      const int kind = random_.chance(0.15) ? 2 : random_.below(2);
      const double wheelbase = vehicleWheelbase(static_cast<VehicleKind>(kind));
      Eigen::Isometry3d pose = groundPose(
          traits_.terrain, p, campus_.road.left_kerb - 1.15 + random_.uniform(-0.12, 0.1), wheelbase);
      const double turned = (random_.chance(0.5) ? 0.0 : std::numbers::pi) + random_.uniform(-0.03, 0.03);
      pose = pose * Eigen::Translation3d(0.5 * wheelbase, 0.0, 0.0) *
             Eigen::AngleAxisd(turned, Eigen::Vector3d::UnitZ()) *
             Eigen::Translation3d(-0.5 * wheelbase, 0.0, 0.0);
      campus_.instances.push_back(paintedInstance(kinds[kind], random_));
      campus_.instances.back().placement = toAffine(pose);
    }
  }

 private:
  std::uint32_t addMesh(Mesh mesh) { return campus_.addMesh(std::move(mesh)); }
  Mesh& fixed() { return campus_.meshes.front(); }

  /// Whether a disc at `place` lies outside road and pavements.
  bool clearOfRoad(const Vector2d& place, double radius) const {
    if (traits_.open && distanceToPath(place) < kOpenClearance + radius) return false;
    for (const PathPoint& p : samples_) {
      const Vector2d offset = place - p.position;
      if (offset.squaredNorm() > 900.0) continue;
      const double along = offset.dot(p.tangent);
      if (std::abs(along) > 1.5) continue;
      const double left = p.tangent.x() * offset.y() - p.tangent.y() * offset.x();
      if (left > campus_.road.rightBorder() - radius && left < campus_.road.leftBorder() + radius)
        return false;
    }
    return true;
  }
  bool clearOfBuildings(const Vector2d& place, double margin) const {
    return std::none_of(buildings_.begin(), buildings_.end(),
                        [&](const Building& b) { return covers(b, place, margin); });
  }
  bool hasRoom(const Building& house) const {
    const Vector2d x(std::cos(house.yaw), std::sin(house.yaw));
    const Vector2d y(-x.y(), x.x());
    for (const double a : stepsBelow(0.51, -0.5, 0.125)) {
      for (const double b : stepsBelow(0.51, -0.5, 0.125)) {
        const Vector2d p = house.centre + a * house.length * x + b * house.depth * y;
        if (!clearOfRoad(p, 1.8) || !clearOfBuildings(p, 2.5)) return false;
      }
    }
    return true;
  }
  void tryBuilding(const Vector2d& centre, double yaw, int max_storeys) {
    Building house;
    house.centre = centre;
    house.yaw = yaw;
    house.length = random_.uniform(11.0, 24.0);
    house.depth = random_.uniform(8.0, 13.0);
    house.storeys = 1 + random_.below(max_storeys);
    const double kind = random_.uniform(0.0, 1.0);
    house.wall = kind < 0.5 ? Material::brick : kind < 0.75 ? Material::plaster : Material::concrete;
    if (traits_.sparse) house.wall = Material::plaster;
    house.seed = random_.bits();
    if (!hasRoom(house)) return;
    buildings_.push_back(house);
    addBuilding(fixed(), house, traits_.terrain);
  }
  void place(std::uint32_t mesh, const Vector2d& at, double yaw, double scale) {
    Instance instance;
    instance.mesh = mesh;
    instance.placement = placementOnGround(at, yaw) * Eigen::Scaling(static_cast<float>(scale));
    instance.seed = random_.bits();
    instance.tone_shift = random_.real(-0.3, 0.3);
    campus_.instances.push_back(instance);
  }
  Vector2d randomPosition(double margin) {
    Eigen::AlignedBox2d bounds;
    for (const PathPoint& p : samples_)
      bounds.extend(p.position);
    return {random_.uniform(bounds.min().x() - margin, bounds.max().x() + margin),
            random_.uniform(bounds.min().y() - margin, bounds.max().y() + margin)};
  }
  Eigen::Affine3f placementOnGround(const Vector2d& at, double yaw) const {
    const Eigen::Vector3d foot(at.x(), at.y(), traits_.terrain.landHeight(at.x(), at.y()) - 0.08);
    return Eigen::Translation3f(foot.cast<float>()) *
           Eigen::Affine3f(Eigen::AngleAxisf(static_cast<float>(yaw), Eigen::Vector3f::UnitZ()));
  }
  double distanceToPath(const Vector2d& at) const {
    double nearest = 1e9;
    for (const PathPoint& p : samples_)
      nearest = std::min(nearest, (at - p.position).norm());
    return nearest;
  }

  const Path& path_;
  Campus& campus_;
  Random random_;
  const ScenarioTraits traits_;
  std::vector<PathPoint> samples_;
  std::vector<Building> buildings_;
};

}  // namespace

Path campusPath(const WorldSettings& settings) {
  Random random(hashOf({static_cast<std::uint32_t>(settings.seed), 102U}));
  const ScenarioTraits traits = traitsOf(settings.scenario);
  std::vector<Vector2d> polygon = traits.polygon;
  const double reach = traits.corner_scatter;
  for (Vector2d& corner : polygon) {
    const double north =
        random.uniform(-reach, reach);  // drawn first: the evaluation order of arguments is unspecified
    corner += Vector2d(random.uniform(-reach, reach), north);
  }
  return Path(polygon, traits.corner_radius);
}

Campus buildCampus(const Path& path, const WorldSettings& settings) {
  const ScenarioTraits traits = traitsOf(settings.scenario);
  Campus campus;
  campus.road = traits.road;
  campus.meshes.emplace_back();
  campus.instances.emplace_back();
  if (traits.garage) {
    addGarage(campus, path, settings.seed);
    return campus;
  }
  addRoad(campus.meshes.front(), path, campus.road, traits.terrain);
  addGrassland(campus.meshes.front(), path, traits.terrain);
  Layout layout(path, settings, campus);
  layout.addUnderpasses(underpasses(path, settings));
  layout.addBuildings();
  layout.addBorders();
  layout.addLining();
  layout.addAvenue();
  layout.addTrees();
  layout.addStreetFurniture();
  layout.addParkedCars();
  return campus;
}

}  // namespace cartvo::world
