#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include <opencv2/core/mat.hpp>

#include "calib/model/rig.hpp"
#include "capture/pair_synchroniser.hpp"
#include "lab/render/motion/drive.hpp"
#include "lab/render/scene/path.hpp"
#include "lab/render/surface/lighting.hpp"
#include "lab/render/surface/material.hpp"
#include "lab/render/tracing/lens.hpp"
#include "lab/render/tracing/photometry.hpp"
#include "lab/render/tracing/renderer.hpp"
#include "lab/render/world_settings.hpp"
#include "tools/simulate/content.hpp"

namespace cartvo::world {

/// Motion of the body that a vibrating mount of the cameras makes: both cameras turn about the same place.
/// Twice continuously differentiable in time.
class MountShake {
 public:
  /// `mount`: the place that does not move, in body axes, m.
  MountShake(const WorldSettings& settings, const Eigen::Vector3d& mount);

  /// Pose of the shaken body in the axes of the body at rest. The identity until the end of the lead-in; the
  /// full amplitude a second later.
  Eigen::Isometry3d T_body_shaken(double seconds) const;

 private:
  Shake shake_;
  double start_ = 0.0;  ///< s
  Eigen::Vector3d mount_;
};

/// Ground truth of one image.
struct DepthImage {
  cv::Mat depth;   ///< CV_32FC1: depth along the camera's z axis at the pixel's centre, m; 0: sky
  cv::Mat moving;  ///< CV_8UC1: 255 where the pixel shows a moving object, else 0
};

/// A golf cart's drive over a procedural campus, with exact ground truth. Images are raw (distorted by the
/// lenses of rig()) and rendered at each camera's own exposure instant, which is that of the middle row; with
/// a rolling shutter, each row at its own instant. They depend on the settings alone.
class RenderedWorld final : public simulate::Content {
 public:
  /// Throws std::invalid_argument that names the setting out of range.
  explicit RenderedWorld(const WorldSettings& settings);
  ~RenderedWorld() override;
  RenderedWorld(const RenderedWorld&) = delete;
  RenderedWorld& operator=(const RenderedWorld&) = delete;

  calib::Rig rig() const override { return rig_; }
  double frameRate() const override { return settings_.frame_rate; }
  int pairCount() const override;
  std::int64_t leftInstant(int index) const override;
  std::int64_t rightInstant(int index) const override;
  /// Thread-safe; calls are serialised, each renders on `threads` threads.
  void images(int index, cv::Mat& left, cv::Mat& right) const override;
  bool startsAtStandstill() const override;
  Trajectory truth() const override;
  Trajectory denseTruth() const override;
  std::string cacheKey() const override;

  const WorldSettings& settings() const { return settings_; }

  /// The image of one camera (CV_8UC1).
  cv::Mat image(int index, capture::CameraSide side) const;

  /// Radiance of that image, CV_32FC1, unit as in meanRadiance(): before lens blur, exposure, noise, tone
  /// curve and rounding. For tests of the renderer.
  cv::Mat radiance(int index, capture::CameraSide side) const;

  /// Depth and moving objects of that image, by one ray through each pixel's centre.
  DepthImage renderDepth(int index, capture::CameraSide side) const;

  /// Mean radiance of the left camera's view at `seconds` (1: a white surface that faces the midday sun).
  double meanRadiance(double seconds) const;

  /// Instant of a row of an image, s after the content's start: that of the image plus the row's share of the
  /// readout.
  double rowInstant(int index, capture::CameraSide side, double row) const;

  /// The cart's exact pose at `seconds` after the content's start, with the vibration of the cameras' mount;
  /// world: the body axes at 0. Before its start and after its end, the drive goes on at the same
  /// speed, a lively one for two seconds.
  Eigen::Isometry3d T_world_body(double seconds) const;

 private:
  struct SceneState;

  double driveInstant(double seconds) const;
  Eigen::Isometry3d T_map_body(double seconds) const;
  double readout(std::size_t camera) const;
  SceneState& sceneState() const;
  void moveTo(double seconds, double readout) const;
  View viewAt(double seconds, const RayTable& table, std::size_t camera) const;
  View rowViewAt(double seconds, std::size_t camera) const;
  cv::Mat radianceAt(double seconds, std::size_t camera) const;
  double meanRadianceAt(double seconds) const;
  void meterExposure() const;

  const WorldSettings settings_;
  const calib::Rig rig_;
  const Path path_;
  const Drive drive_;
  const Lighting lighting_;
  const TextureStyle style_;
  const std::array<RayTable, 2> rays_;
  const calib::CameraModel meter_model_;
  const RayTable meter_rays_;
  const std::array<Eigen::Isometry3d, 2> T_body_camera_;
  const MountShake shake_;
  const Eigen::Isometry3d T_start_map_;
  mutable std::unique_ptr<SceneState> scene_state_;  ///< built with the first image
  mutable std::optional<ExposureControl> exposure_;  ///< metered with the first image
  mutable std::mutex mutex_;  ///< guards scene_state_ and exposure_; the scene is moved for each image
};

}  // namespace cartvo::world
