// Moves vehicles and pedestrians as functions of time.
#include "lab/render/scene/traffic.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "lab/render/scene/person.hpp"
#include "lab/render/scene/steps.hpp"
#include "lab/render/scene/vehicle.hpp"
#include "lab/render/surface/patterns.hpp"

namespace cartvo::world {
namespace {

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
