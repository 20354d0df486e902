#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <embree3/rtcore.h>

#include "lab/render/scene/campus.hpp"

namespace cartvo::world {

/// Meshes and their instances as a two-level Embree scene (https://www.embree.org) for ray tracing.
class Scene {
 public:
  /// `meshes` and `instances` must outlive the scene. The moving instances have a placement at each of
  /// `time_steps` instants at equal distances, and move linearly in between; one: they stand still. Throws
  /// std::runtime_error if Embree reports an error.
  Scene(const std::vector<Mesh>& meshes, const std::vector<Instance>& instances, int time_steps);

  int timeSteps() const { return static_cast<int>(directions_.size()); }

  /// Takes the current placements of the moving instances as those at a time step.
  void place(int time_step);

  /// Applies the placements of all time steps.
  void update();

  RTCScene handle() const { return top_.get(); }
  const Instance& instance(std::uint32_t id) const { return instances_[id]; }
  const QuadShading& shading(std::uint32_t instance_id, std::uint32_t quad) const {
    return meshes_[instances_[instance_id].mesh].shading(quad);
  }
  /// Matrix that maps normals and texture gradients of an instance to campus axes, at the time step next to
  /// `time` (0: the first, 1: the last one).
  const Eigen::Matrix3f& directions(std::uint32_t id, float time) const {
    const float step = time * static_cast<float>(directions_.size() - 1);
    return directions_[static_cast<std::size_t>(std::lround(step))][id];
  }

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
  std::vector<std::vector<Eigen::Matrix3f>> directions_;  ///< at each time step, of each instance
};

}  // namespace cartvo::world
