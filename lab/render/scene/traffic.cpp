// Moves vehicles and pedestrians as functions of time.
#include "lab/render/scene/traffic.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>

#include "lab/render/scene/mesh.hpp"
#include "lab/render/scene/steps.hpp"
#include "lab/render/scene/vehicle.hpp"
#include "lab/render/surface/patterns.hpp"

namespace cartvo::world {
namespace {

// Builds the parts of a pedestrian and animates the walk.

using Eigen::Vector3f;

constexpr double kHip = 0.88;       // m above the ground
constexpr double kShoulder = 1.42;  // m
constexpr double kStride = 1.5;     // m, length of two steps

const Finish kCloth{Material::cloth, 1, 0.5F};
const Finish kTrousers{Material::cloth, 2, 0.25F};
const Finish kSkin{Material::plaster, 3, 0.2F};
const Finish kHair{Material::bark, 4, 0.3F};

/// Parts of a walking person. Legs and arms have their joint at the origin.
Mesh makeTorso() {
  Mesh mesh;
  mesh.addColumn(Vector3f(0, 0, 0.85F), Vector3f(0, 0, 1.15F), 0.165F, 0.15F, 10, kCloth);
  mesh.addColumn(Vector3f(0, 0, 1.15F), Vector3f(0, 0, 1.40F), 0.15F, 0.20F, 10, kCloth);
  mesh.addColumn(Vector3f(0, 0, 1.40F), Vector3f(0, 0, 1.48F), 0.20F, 0.07F, 10, kCloth);
  mesh.addColumn(Vector3f(0, 0, 1.46F), Vector3f(0.01F, 0, 1.56F), 0.055F, 0.06F, 8, kSkin);
  mesh.addColumn(Vector3f(0.01F, 0, 1.54F), Vector3f(0.01F, 0, 1.66F), 0.075F, 0.095F, 10, kSkin);
  mesh.addColumn(Vector3f(0.0F, 0, 1.65F), Vector3f(-0.01F, 0, 1.76F), 0.1F, 0.04F, 10, kHair);
  mesh.addBox(Vector3f(-0.2F, 0, 1.05F), Vector3f(0.14F, 0.28F, 0.38F), 0.0F, {Material::cloth, 5, 0.7F});
  return mesh;
}

Mesh makeLeg() {
  Mesh mesh;
  mesh.addColumn(Vector3f(0, 0, 0), Vector3f(0.02F, 0, -0.42F), 0.095F, 0.07F, 8, kTrousers);
  mesh.addColumn(Vector3f(0.02F, 0, -0.42F), Vector3f(0, 0, -0.82F), 0.07F, 0.05F, 8, kTrousers);
  mesh.addBox(Vector3f(0.05F, 0, -0.88F), Vector3f(0.26F, 0.09F, 0.09F), 0.0F, {Material::rubber, 6, 0.5F});
  return mesh;
}

Mesh makeArm() {
  Mesh mesh;
  mesh.addColumn(Vector3f(0, 0, 0), Vector3f(-0.01F, 0, -0.30F), 0.055F, 0.045F, 7, kCloth);
  mesh.addColumn(Vector3f(-0.01F, 0, -0.30F), Vector3f(0.05F, 0, -0.58F), 0.045F, 0.035F, 7, kCloth);
  mesh.addBox(Vector3f(0.06F, 0, -0.68F), Vector3f(0.05F, 0.04F, 0.1F), 0.0F, kSkin);
  return mesh;
}

/// Placements of torso, left leg, right leg, left arm, right arm in the person's axes (x ahead, z up, origin
/// on the ground) after `walked` m.
std::array<Eigen::Isometry3d, 5> limbPlacements(double walked) {
  const double phase = 2.0 * std::numbers::pi * walked / kStride;
  const auto placed_at_joint = [](double y, double z, double swing) {
    Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();
    placement.translation() = Eigen::Vector3d(0.0, y, z);
    placement.linear() = Eigen::AngleAxisd(swing, Eigen::Vector3d::UnitY()).toRotationMatrix();
    return placement;
  };
  const double swing = 0.42 * std::sin(phase);
  return {Eigen::Isometry3d::Identity(), placed_at_joint(0.09, kHip, swing),
          placed_at_joint(-0.09, kHip, -swing), placed_at_joint(0.24, kShoulder, -0.8 * swing),
          placed_at_joint(-0.24, kShoulder, 0.8 * swing)};
}

constexpr double kOtherLane = 3.4;  // m left of the path

Instance moverInstance(std::uint32_t mesh, Random& random) {
  Instance instance = paintedInstance(mesh, random);
  instance.moving = true;
  return instance;
}

/// Adds the parts of a person: torso, leg, arm. Returns the index of the torso.
std::uint32_t addPersonMeshes(Campus& campus) {
  const std::uint32_t torso = campus.addMesh(makeTorso());
  campus.addMesh(makeLeg());
  campus.addMesh(makeArm());
  return torso;
}

}  // namespace

Traffic::Traffic(const Path& path, const Drive& drive, const WorldSettings& settings, Campus& campus)
    : path_(path), drive_(drive), traits_(traitsOf(settings.scenario)) {
  if (traits_.vehicle_spacing > 0.0) addVehicles(settings, campus);
  if (traits_.walkers == Walkers::few) addPedestrians(settings, campus);
  if (traits_.walkers == Walkers::crowd) addCrowd(settings, campus);
}

void Traffic::addVehicles(const WorldSettings& settings, Campus& campus) {
  Random random(hashOf({static_cast<std::uint32_t>(settings.seed), 401U}));
  std::array<std::uint32_t, kVehicleKinds> meshes{};
  for (int kind = 0; kind < kVehicleKinds; ++kind)
    meshes[kind] = campus.addMesh(makeVehicle(static_cast<VehicleKind>(kind)));
  const auto add = [&](VehicleKind kind, Vehicle vehicle) {
    vehicle.instance = static_cast<std::uint32_t>(campus.instances.size());
    vehicle.wheelbase = vehicleWheelbase(kind);
    campus.instances.push_back(moverInstance(meshes[static_cast<std::size_t>(kind)], random));
    vehicles_.push_back(vehicle);
  };
  const auto any_kind = [&] {
    const double kind = random.uniform(0.0, 1.0);
    return kind < 0.4    ? VehicleKind::hatchback
           : kind < 0.7  ? VehicleKind::saloon
           : kind < 0.88 ? VehicleKind::van
                         : VehicleKind::bus;
  };
  const bool heavy = traits_.bus_ahead;
  const bool overtaking = traits_.overtaking;
  const int count = static_cast<int>(path_.length() / traits_.vehicle_spacing);
  const double spacing = path_.length() / count;
  const double speed = overtaking ? 4.5 : 5.5;
  for (int i = 0; i < count; ++i) {
    const double start = spacing * (i + 0.5) + random.uniform(-0.12, 0.12) * spacing;
    const Course course = overtaking ? Course::overtaking : Course::oncoming;
    add((heavy || overtaking) && i % 3 == 1 ? VehicleKind::bus : any_kind(),
        {0, course, start, speed, 0.0, 0.0});
  }
  if (!traits_.vehicle_ahead) return;
  if (heavy) add(VehicleKind::bus, {0, Course::ahead, 8.6, 0.12, random.uniform(0.0, 6.0), 0.0});
  if (!heavy) add(VehicleKind::saloon, {0, Course::ahead, 26.0, 0.25, random.uniform(0.0, 6.0), 0.0});
}

void Traffic::addPerson(Pedestrian person, std::uint32_t torso, Campus& campus, Random& random) {
  person.first_instance = static_cast<std::uint32_t>(campus.instances.size());
  const Instance look = moverInstance(torso, random);
  for (const std::uint32_t part : {torso, torso + 1, torso + 1, torso + 2, torso + 2}) {
    campus.instances.push_back(look);
    campus.instances.back().mesh = part;
  }
  pedestrians_.push_back(person);
}

void Traffic::addPedestrians(const WorldSettings& settings, Campus& campus) {
  Random random(hashOf({static_cast<std::uint32_t>(settings.seed), 402U}));
  const std::uint32_t torso = addPersonMeshes(campus);
  const int count = static_cast<int>(path_.length() / 16.0);
  for (int i = 0; i < count; ++i) {
    Pedestrian person;
    person.start = random.uniform(0.0, path_.length());
    person.speed = random.uniform(1.0, 1.6) * (random.chance(0.5) ? 1.0 : -1.0);
    const bool left = random.chance(0.5);
    const double beside = 0.5 + 0.25 * static_cast<double>(random.below(5));
    person.lateral = left ? campus.road.left_kerb + beside : campus.road.right_kerb - beside;
    person.scale = random.uniform(0.92, 1.07);
    addPerson(person, torso, campus, random);
  }
}

void Traffic::addCrowd(const WorldSettings& settings, Campus& campus) {
  constexpr double kSpacing = 0.9;     // m along the path
  constexpr double kCartSide = 1.3;    // m from the path, kept free for the cart
  constexpr double kParkedCars = 2.4;  // m from the left kerb, kept free for them
  constexpr double kSway = 0.25;       // m
  Random random(hashOf({static_cast<std::uint32_t>(settings.seed), 403U}));
  const std::uint32_t torso = addPersonMeshes(campus);
  const auto any_person = [&] {
    Pedestrian person;
    person.scale = random.uniform(0.92, 1.07);
    person.sway = random.uniform(0.0, kSway);
    person.phase = random.uniform(0.0, 2.0 * std::numbers::pi);
    person.height = 0.0;
    return person;
  };
  for (const double start : stepsBelow(path_.length(), 0.0, kSpacing)) {
    Pedestrian person = any_person();
    person.start = start;
    person.speed = random.uniform(0.9, 1.6) * (random.chance(0.5) ? 1.0 : -1.0);
    person.lateral = random.chance(0.35) ? random.uniform(campus.road.right_kerb, -kCartSide)
                                         : random.uniform(kCartSide, campus.road.left_kerb - kParkedCars);
    addPerson(person, torso, campus, random);
  }
  for (const double ahead : {4.6, 5.6, 6.9, 8.0}) {
    Pedestrian person = any_person();
    person.start = ahead + random.uniform(0.0, 0.5);
    person.lateral = random.uniform(-0.9, 0.9);
    person.escorts = true;
    addPerson(person, torso, campus, random);
  }
}

Eigen::Isometry3d Traffic::vehiclePose(const Vehicle& vehicle, double seconds) const {
  const Eigen::AngleAxisd half_turn(std::numbers::pi, Eigen::Vector3d::UnitZ());
  switch (vehicle.course) {
    case Course::oncoming:
      return groundPose(traits_.terrain, path_.at(vehicle.start - vehicle.speed * seconds), kOtherLane,
                        vehicle.wheelbase) *
             half_turn;
    case Course::ahead: {
      const double distance =
          vehicle.start * (1.0 + vehicle.speed * std::sin(0.37 * seconds + vehicle.phase));
      return groundPose(traits_.terrain, path_.at(drive_.distance(seconds) + distance), 0.0,
                        vehicle.wheelbase);
    }
    case Course::overtaking:
      break;
  }
  // The cart is at standstill at distance 0: vehicles come from behind in the other lane and pull in ahead of
  // it.
  const double along = vehicle.start + vehicle.speed * seconds;
  const double from_cart = along - path_.length() * std::floor(along / path_.length() + 0.5);
  constexpr double kPullInFrom = 3.0;
  constexpr double kPullInTo = 16.0;
  const double t = std::clamp((from_cart - kPullInFrom) / (kPullInTo - kPullInFrom), 0.0, 1.0);
  const double share = t * t * t * (t * (6.0 * t - 15.0) + 10.0);  // zero slope and curvature at both ends
  const double slope = 30.0 * t * t * (t - 1.0) * (t - 1.0) / (kPullInTo - kPullInFrom);
  const double heading = std::atan(-kOtherLane * slope);
  return groundPose(traits_.terrain, path_.at(along), kOtherLane * (1.0 - share), vehicle.wheelbase) *
         Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ());
}

double Traffic::walked(const Pedestrian& person, double seconds) const {
  return person.escorts ? drive_.distance(seconds) : person.speed * seconds;
}

Eigen::Isometry3d Traffic::personPose(const Pedestrian& person, double seconds) const {
  constexpr double kSwayFrequency = 1.1;  // rad/s
  const PathPoint at = path_.at(person.start + walked(person, seconds));
  const double lateral = person.lateral + person.sway * std::sin(kSwayFrequency * seconds + person.phase);
  const Eigen::Isometry3d ground = groundPose(traits_.terrain, at, clampWithinBend(at, lateral), 0.3);
  const Eigen::Vector3d foot = ground.translation() + Eigen::Vector3d(0.0, 0.0, person.height);
  Eigen::Isometry3d pose =
      Eigen::Translation3d(foot) *
      Eigen::AngleAxisd(std::atan2(at.tangent.y(), at.tangent.x()), Eigen::Vector3d::UnitZ());
  if (person.speed >= 0.0) return pose;
  return pose * Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ());
}

void Traffic::placeAt(double seconds, std::vector<Instance>& instances) const {
  for (const Vehicle& vehicle : vehicles_) {
    instances[vehicle.instance].placement = toAffine(vehiclePose(vehicle, seconds));
  }
  for (const Pedestrian& person : pedestrians_) {
    const auto limbs = limbPlacements(std::abs(walked(person, seconds)) / person.scale);
    for (std::size_t i = 0; i < limbs.size(); ++i) {
      Eigen::Affine3f placement = toAffine(personPose(person, seconds));
      placement.scale(static_cast<float>(person.scale));
      instances[person.first_instance + i].placement = placement * toAffine(limbs[i]);
    }
  }
}

}  // namespace cartvo::world
