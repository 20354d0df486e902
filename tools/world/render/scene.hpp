#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <vector>

#include <embree3/rtcore.h>

#include "tools/world/scene/campus.hpp"

namespace cartvo::world {

/// Meshes and their instances as a two-level Embree scene (https://www.embree.org) for ray tracing.
class Scene {
 public:
  /// `meshes` and `instances` must outlive the scene. Throws std::runtime_error if Embree reports an error.
  Scene(const std::vector<Mesh>& meshes, const std::vector<Instance>& instances);

  /// Applies the current placements of the moving instances.
  void update();

  RTCScene handle() const { return top_.get(); }
  const Instance& instance(std::uint32_t id) const { return instances_[id]; }
  const QuadShading& shading(std::uint32_t instance_id, std::uint32_t quad) const {
    return meshes_[instances_[instance_id].mesh].shading(quad);
  }
  /// Matrix that maps normals and texture gradients of an instance to campus axes.
  const Eigen::Matrix3f& directions(std::uint32_t id) const { return directions_[id]; }

 private:
  struct Release {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  };
  using Device = std::unique_ptr<RTCDeviceTy, Release>;
  using Handle = std::unique_ptr<RTCSceneTy, Release>;

  Handle buildMesh(const Mesh& mesh) const;
  void check() const;

  const std::vector<Mesh>& meshes_;
  const std::vector<Instance>& instances_;
  Device device_;
  std::vector<Handle> bottom_;
  Handle top_;
  std::vector<Eigen::Matrix3f> directions_;
};

}  // namespace cartvo::world
