// Builds the Embree scene of the campus and moves its instances.
#include "lab/render/tracing/scene.hpp"

#include <cstring>
#include <stdexcept>
#include <string>

namespace cartvo::world {
namespace {

void setTransform(RTCGeometry geometry, int time_step, const Eigen::Affine3f& placement) {
  const Eigen::Matrix4f& matrix = placement.matrix();  // column-major, as Embree expects
  rtcSetGeometryTransform(geometry, static_cast<unsigned>(time_step), RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR,
                          matrix.data());
}

/// Inverse transpose of the linear part: maps normals and texture gradients from mesh to campus axes.
Eigen::Matrix3f inverseTransposed(const Eigen::Affine3f& placement) {
  return placement.linear().inverse().transpose();
}

}  // namespace

Scene::Scene(const std::vector<Mesh>& meshes, const std::vector<Instance>& instances, int time_steps)
    : meshes_(meshes),
      instances_(instances),
      device_(rtcNewDevice("threads=2")),
      directions_(static_cast<std::size_t>(time_steps)) {
  check();
  for (const Mesh& mesh : meshes)
    bottom_.push_back(buildMesh(mesh));
  top_.reset(rtcNewScene(device_.get()));
  rtcSetSceneBuildQuality(top_.get(), RTC_BUILD_QUALITY_MEDIUM);
  for (std::uint32_t id = 0; id < instances.size(); ++id) {
    RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, bottom_[instances[id].mesh].get());
    const int steps = instances[id].moving ? time_steps : 1;
    rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(steps));
    for (int step = 0; step < steps; ++step)
      setTransform(geometry, step, instances[id].placement);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(top_.get(), geometry, id);
    rtcReleaseGeometry(geometry);
    for (std::vector<Eigen::Matrix3f>& directions : directions_)
      directions.push_back(inverseTransposed(instances[id].placement));
  }
  rtcCommitScene(top_.get());
  check();
}

Scene::Handle Scene::buildMesh(const Mesh& mesh) const {
  Handle scene(rtcNewScene(device_.get()));
  rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_HIGH);
  RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_QUAD);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices().size()));
  auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 4 * sizeof(std::uint32_t), mesh.size()));
  if (vertices == nullptr || indices == nullptr) {
    rtcReleaseGeometry(geometry);
    throw std::runtime_error("Embree: no memory for a mesh of " + std::to_string(mesh.size()) +
                             " quadrilaterals");
  }
  for (const Eigen::Vector3f& vertex : mesh.vertices()) {
    for (int axis = 0; axis < 3; ++axis)
      *vertices++ = vertex[axis];
  }
  for (std::uint32_t i = 0; i < 4 * mesh.size(); ++i)
    indices[i] = i;
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene.get(), geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene.get());
  return scene;
}

void Scene::place(int time_step) {
  for (std::uint32_t id = 0; id < instances_.size(); ++id) {
    if (!instances_[id].moving) continue;
    setTransform(rtcGetGeometry(top_.get(), id), time_step, instances_[id].placement);
    directions_[static_cast<std::size_t>(time_step)][id] = inverseTransposed(instances_[id].placement);
  }
}

void Scene::update() {
  for (std::uint32_t id = 0; id < instances_.size(); ++id) {
    if (instances_[id].moving) rtcCommitGeometry(rtcGetGeometry(top_.get(), id));
  }
  rtcCommitScene(top_.get());
}

void Scene::check() const {
  const RTCError error = rtcGetDeviceError(device_.get());
  if (device_ == nullptr || error != RTC_ERROR_NONE) {
    throw std::runtime_error("Embree failed with error " + std::to_string(static_cast<int>(error)));
  }
}

}  // namespace cartvo::world
