// Shears plants about their feet and moves groups of fallen leaves.
#include "lab/render/motion/wind.hpp"

#include <cmath>

#include "lab/render/scenario_traits.hpp"
#include "lab/render/scene/steps.hpp"
#include "lab/render/scene/vegetation.hpp"
#include "lab/render/surface/hash.hpp"

namespace cartvo::world {

Wind::Wind(const Path& path, const WorldSettings& settings, Campus& campus)
    : path_(path), terrain_(traitsOf(settings.scenario).terrain) {
  if (!traitsOf(settings.scenario).wind) return;
  Random random(hashOf({static_cast<std::uint32_t>(settings.seed), 701U}));
  for (std::uint32_t i = 0; i < campus.instances.size(); ++i) {
    Instance& instance = campus.instances[i];
    if (instance.sway == 0.0F) continue;
    instance.moving = true;
    plants_.push_back({i, instance.placement, instance.sway, random.uniform(0.0, 6.28)});
  }
  addLeaves(settings, campus);
}

void Wind::addLeaves(const WorldSettings& settings, Campus& campus) {
  constexpr int kKinds = 4;
  constexpr double kSpacing = 1.6;  // m along the path
  Random random(hashOf({static_cast<std::uint32_t>(settings.seed), 702U}));
  const auto first = static_cast<std::uint32_t>(campus.meshes.size());
  for (int i = 0; i < kKinds; ++i)
    campus.meshes.push_back(makeBlownLeaves(random.bits()));
  for (const double start : stepsBelow(path_.length(), 0.0, kSpacing)) {
    Leaves leaves;
    leaves.instance = static_cast<std::uint32_t>(campus.instances.size());
    leaves.start = start;
    leaves.lateral = random.uniform(campus.road.right_kerb, campus.road.left_kerb);
    leaves.speed = random.uniform(0.5, 3.0);
    leaves.spin = random.uniform(-1.5, 1.5);
    leaves_.push_back(leaves);
    Instance instance;
    instance.mesh = first + static_cast<std::uint32_t>(random.below(kKinds));
    instance.seed = random.bits();
    instance.moving = true;
    campus.instances.push_back(instance);
  }
}

void Wind::placeAt(double seconds, std::vector<Instance>& instances) const {
  constexpr double kGusts = 2.1, kFlutter = 7.5;  // rad/s
  const Eigen::Vector3f downwind = Eigen::Vector3f(0.8F, 0.6F, 0.0F);
  for (const Plant& plant : plants_) {
    const double bend = 0.6 + 0.7 * std::sin(kGusts * seconds + plant.phase) +
                        0.3 * std::sin(kFlutter * seconds + 2.0 * plant.phase);
    Eigen::Affine3f& placement = instances[plant.instance].placement;
    placement = plant.upright;
    const Eigen::Matrix3f shear = Eigen::Matrix3f::Identity() + plant.sway * static_cast<float>(bend) *
                                                                    downwind * Eigen::RowVector3f::UnitZ();
    placement.linear() = shear * plant.upright.linear();
  }
  for (const Leaves& leaves : leaves_) {
    const double gust = 0.5 * std::sin(kGusts * seconds + leaves.start);
    const PathPoint at = path_.at(leaves.start + leaves.speed * seconds + gust);
    const Eigen::Isometry3d pose = groundPose(terrain_, at, clampWithinBend(at, leaves.lateral), 0.3) *
                                   Eigen::AngleAxisd(leaves.spin * seconds, Eigen::Vector3d::UnitZ());
    instances[leaves.instance].placement = toAffine(pose);
  }
}

}  // namespace cartvo::world
