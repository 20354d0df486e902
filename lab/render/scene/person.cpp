// Builds the parts of a pedestrian and animates the walk.
#include "lab/render/scene/person.hpp"

#include <cmath>
#include <numbers>

namespace cartvo::world {
namespace {

using Eigen::Vector3f;

constexpr double kHip = 0.88;       // m above the ground
constexpr double kShoulder = 1.42;  // m
constexpr double kStride = 1.5;     // m, length of two steps

const Finish kCloth{Material::cloth, 1, 0.5F};
const Finish kTrousers{Material::cloth, 2, 0.25F};
const Finish kSkin{Material::plaster, 3, 0.2F};
const Finish kHair{Material::bark, 4, 0.3F};

}  // namespace

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

}  // namespace cartvo::world
