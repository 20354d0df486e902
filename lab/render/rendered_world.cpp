// Combines path, campus, drive, traffic, cameras and light into simulated images with ground truth.
#include "lab/render/rendered_world.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include <opencv2/core.hpp>

#include "lab/render/motion/wind.hpp"
#include "lab/render/scenario_traits.hpp"
#include "lab/render/scene/campus.hpp"
#include "lab/render/scene/steps.hpp"
#include "lab/render/scene/traffic.hpp"
#include "lab/render/surface/hash.hpp"
#include "lab/render/tracing/photometry.hpp"
#include "lab/render/tracing/scene.hpp"

namespace cartvo::world {
namespace {

/// Part of the cache key; to be raised whenever the same settings give other images.
constexpr int kRenderVersion = 4;

/// Placements of moving objects within a rolling shutter's readout. Between two of them, 8 ms apart, the
/// acceleration of a vehicle makes less than 0.1 mm.
constexpr int kTimeSteps = 5;

constexpr double kMaxMeteredRadiance = 2.0;  // saturated pixels count as this in metering

/// Share of a readout at which a row is exposed: -1/2 at the upper edge of the image, 1/2 at the lower one.
double rowShare(double row, int rows) {
  return (row + 0.5) / rows - 0.5;
}

std::size_t sideIndex(capture::CameraSide side) {
  return side == capture::CameraSide::left ? 0 : 1;
}

/// Instant of an image, s after the content's start.
double instantOf(const RenderedWorld& world, int index, capture::CameraSide side) {
  const bool left = side == capture::CameraSide::left;
  return 1e-9 * static_cast<double>(left ? world.leftInstant(index) : world.rightInstant(index));
}

TextureStyle styleOf(const WorldSettings& settings) {
  return {traitsOf(settings.scenario).texture_contrast, static_cast<std::uint32_t>(settings.seed) * 7919U};
}

/// Seed of the sample patterns from the camera pose, rounded to 0.01 mm and 1 urad. A camera at standstill
/// keeps its rays, so that the static scene does not flicker; a moving camera gets other rays in each image,
/// so that sampling leaves no fixed pattern.
std::uint32_t samplePatternSeed(const Eigen::Isometry3d& T_map_camera) {
  std::uint32_t seed = 0;
  const auto mix = [&](double value, double step) {
    seed = hashOf({seed, static_cast<std::uint32_t>(std::llround(value / step))});
  };
  for (const double metres : T_map_camera.translation())
    mix(metres, 1e-5);
  for (const double element : T_map_camera.linear().reshaped())
    mix(element, 1e-6);
  return seed;
}

/// The camera with the same field of view in 34 px width, for exposure metering.
calib::CameraModel meterModel(const calib::CameraModel& camera) {
  calib::CameraModel model = camera;
  const double scale = 34.0 / camera.size.width;
  model.size = cv::Size(34, std::max(1, static_cast<int>(std::lround(camera.size.height * scale))));
  model.fx *= scale;
  model.fy *= scale;
  model.cx = (camera.cx + 0.5) * scale - 0.5;
  model.cy = (camera.cy + 0.5) * scale - 0.5;
  return model;
}

}  // namespace

/// The part of the world that images need and the truth does not; expensive to build.
struct RenderedWorld::SceneState {
  SceneState(const Path& path, const Drive& drive, const WorldSettings& settings)
      : campus(buildCampus(path, settings)),
        traffic(path, drive, settings, campus),
        wind(path, settings, campus),
        scene(campus.meshes, campus.instances,
              settings.left_readout == 0.0 && settings.right_readout == 0.0 ? 1 : kTimeSteps) {}

  Campus campus;
  Traffic traffic;
  Wind wind;
  Scene scene;
};

RenderedWorld::RenderedWorld(const WorldSettings& settings)
    : settings_(validated(settings)),
      rig_(simulatedRig(settings_)),
      path_(campusPath(settings_)),
      drive_(path_, settings_),
      lighting_(buildLighting(settings_, path_)),
      style_(styleOf(settings_)),
      rays_{RayTable(rig_.left), RayTable(rig_.right)},
      meter_model_(meterModel(rig_.left)),
      meter_rays_(meter_model_),
      T_body_camera_{rig_.T_body_camera, rig_.T_body_camera * rig_.T_right_left.inverse()},
      shake_(settings_, 0.5 * (T_body_camera_[0].translation() + T_body_camera_[1].translation())),
      T_start_map_(T_map_body(0.0).inverse()) {}

RenderedWorld::~RenderedWorld() = default;

/// Instant of the drive, s, at `seconds` after the content's start.
double RenderedWorld::driveInstant(double seconds) const {
  return startOf(settings_) + seconds;
}

Eigen::Isometry3d RenderedWorld::T_map_body(double seconds) const {
  return drive_.T_map_body(driveInstant(seconds)) * shake_.T_body_shaken(driveInstant(seconds));
}

double RenderedWorld::readout(std::size_t camera) const {
  return camera == 0 ? settings_.left_readout : settings_.right_readout;
}

RenderedWorld::SceneState& RenderedWorld::sceneState() const {
  if (scene_state_ == nullptr) scene_state_ = std::make_unique<SceneState>(path_, drive_, settings_);
  return *scene_state_;
}

/// Moves the objects to their places within a readout whose middle is at `seconds`.
void RenderedWorld::moveTo(double seconds, double readout) const {
  SceneState& state = sceneState();
  for (int step = 0; step < state.scene.timeSteps(); ++step) {
    const double share =
        state.scene.timeSteps() == 1 ? 0.0 : static_cast<double>(step) / (kTimeSteps - 1) - 0.5;
    const double instant = driveInstant(seconds + share * readout);
    state.traffic.placeAt(instant, state.campus.instances);
    state.wind.placeAt(instant, state.campus.instances);
    state.scene.place(step);
  }
  state.scene.update();
}

/// A camera all of whose rows are exposed at `seconds`.
View RenderedWorld::viewAt(double seconds, const RayTable& table, std::size_t camera) const {
  const Eigen::Isometry3d T_map_camera = T_map_body(seconds) * T_body_camera_[camera];
  View view;
  view.rays = &table;
  view.size = settings_.image_size;
  view.T_map_camera = {T_map_camera.cast<float>()};
  view.sample_seed = samplePatternSeed(T_map_camera);
  return view;
}

/// A camera whose middle row is exposed at `seconds` and each row at its own instant.
View RenderedWorld::rowViewAt(double seconds, std::size_t camera) const {
  View view = viewAt(seconds, rays_[camera], camera);
  if (readout(camera) == 0.0) return view;
  view.T_map_camera.clear();
  for (int row = 0; row < view.size.height; ++row) {
    const double instant = seconds + readout(camera) * rowShare(row, view.size.height);
    view.T_map_camera.emplace_back((T_map_body(instant) * T_body_camera_[camera]).cast<float>());
  }
  return view;
}

cv::Mat RenderedWorld::radianceAt(double seconds, std::size_t camera) const {
  moveTo(seconds, readout(camera));
  const RenderSettings sampling{settings_.edge_samples, settings_.threads};
  cv::Mat radiance =
      renderRadiance(sceneState().scene, lighting_, style_, sampling, rowViewAt(seconds, camera));
  addVeilingGlare(radiance, (camera == 0 ? rig_.left : rig_.right).fx);
  if (traitsOf(settings_.scenario).drops_on_lens)
    addLensDrops(radiance,
                 hashOf({static_cast<std::uint32_t>(settings_.seed), static_cast<std::uint32_t>(camera)}));
  return radiance;
}

double RenderedWorld::meanRadianceAt(double seconds) const {
  moveTo(seconds, 0.0);
  View view = viewAt(seconds, meter_rays_, 0);
  view.size = meter_model_.size;
  cv::Mat radiance =
      renderRadiance(sceneState().scene, lighting_, style_, RenderSettings{0, settings_.threads}, view);
  addVeilingGlare(radiance, meter_model_.fx);
  return cv::mean(cv::min(radiance, kMaxMeteredRadiance))[0];
}

/// Meters the radiance over the drive, once.
void RenderedWorld::meterExposure() const {
  if (exposure_) return;
  std::vector<double> metered;
  for (const double t : stepsBelow(settings_.seconds + 1.0, 0.0, ExposureControl::kMeterStep))
    metered.push_back(meanRadianceAt(t));
  exposure_.emplace(settings_, metered);
}

int RenderedWorld::pairCount() const {
  return std::max(1, static_cast<int>(std::floor(settings_.seconds * frameRate())));
}

std::int64_t RenderedWorld::leftInstant(int index) const {
  return std::llround(1e9 * (index * (1.0 / settings_.frame_rate)));
}

std::int64_t RenderedWorld::rightInstant(int index) const {
  const double period = 1.0 / settings_.frame_rate;
  return std::llround(1e9 *
                      (settings_.offset_s + index * period * (1.0 + 1e-6 * settings_.offset_drift_ppm)));
}

double RenderedWorld::rowInstant(int index, capture::CameraSide side, double row) const {
  return instantOf(*this, index, side) +
         readout(sideIndex(side)) * rowShare(row, settings_.image_size.height);
}

void RenderedWorld::images(int index, cv::Mat& left, cv::Mat& right) const {
  left = image(index, capture::CameraSide::left);
  right = image(index, capture::CameraSide::right);
}

cv::Mat RenderedWorld::image(int index, capture::CameraSide side) const {
  const std::lock_guard lock(mutex_);
  meterExposure();
  const std::size_t camera = sideIndex(side);
  const double seconds = instantOf(*this, index, side);
  const std::uint32_t image_seed =
      hashOf({static_cast<std::uint32_t>(settings_.seed), static_cast<std::uint32_t>(index),
              static_cast<std::uint32_t>(camera)});
  SensorSettings sensor;
  sensor.gain = camera == 0 ? 1.0F : 1.03F;
  const calib::CameraModel& model = camera == 0 ? rig_.left : rig_.right;
  sensor.vignette_centre = cv::Point2f(static_cast<float>(model.cx), static_cast<float>(model.cy));
  sensor.vignette = camera == 0 ? 0.30F : 0.33F;
  sensor.noise = static_cast<float>(settings_.noise);
  return exposeImage(radianceAt(seconds, camera), exposure_->exposure(seconds), sensor,
                     mixBits(image_seed + 17U), settings_.threads);
}

cv::Mat RenderedWorld::radiance(int index, capture::CameraSide side) const {
  const std::lock_guard lock(mutex_);
  return radianceAt(instantOf(*this, index, side), sideIndex(side));
}

DepthImage RenderedWorld::renderDepth(int index, capture::CameraSide side) const {
  const std::lock_guard lock(mutex_);
  const std::size_t camera = sideIndex(side);
  const double seconds = instantOf(*this, index, side);
  moveTo(seconds, readout(camera));
  DepthImage result;
  renderDepthAndMotion(sceneState().scene, RenderSettings{0, settings_.threads}, rowViewAt(seconds, camera),
                       result.depth, result.moving);
  return result;
}

double RenderedWorld::meanRadiance(double seconds) const {
  const std::lock_guard lock(mutex_);
  return meanRadianceAt(seconds);
}

Eigen::Isometry3d RenderedWorld::T_world_body(double seconds) const {
  return T_start_map_ * T_map_body(seconds);
}

bool RenderedWorld::startsAtStandstill() const {
  return drive_.speed(driveInstant(0.0)) == 0.0;
}

Trajectory RenderedWorld::truth() const {
  Trajectory truth;
  for (int index = 0; index < pairCount(); ++index) {
    const std::int64_t instant = leftInstant(index);
    truth.push_back({instant, T_world_body(1e-9 * static_cast<double>(instant))});
  }
  return truth;
}

Trajectory RenderedWorld::denseTruth() const {
  constexpr std::int64_t kPosesPerPair = 5;
  Trajectory truth;
  for (int index = 0; index < pairCount(); ++index) {
    const std::int64_t instant = leftInstant(index);
    const std::int64_t period = index + 1 < pairCount() ? leftInstant(index + 1) - instant : 0;
    for (std::int64_t part = 0; part < (period > 0 ? kPosesPerPair : 1); ++part) {
      const std::int64_t time = instant + part * period / kPosesPerPair;
      truth.push_back({time, T_world_body(1e-9 * static_cast<double>(time))});
    }
  }
  return truth;
}

std::string RenderedWorld::cacheKey() const {
  const WorldSettings& s = settings_;
  std::ostringstream key;
  key.precision(17);
  key << "world-" << kRenderVersion << '-' << scenarioName(s.scenario) << "-seed" << s.seed << '-'
      << s.seconds << "s-lead" << s.lead_in_seconds << '-' << s.frame_rate << "Hz-offset" << s.offset_s
      << "s-drift" << s.offset_drift_ppm << "ppm-" << s.image_size.width << 'x' << s.image_size.height << "-f"
      << s.focal_length << "-b" << s.baseline << "-edge" << s.edge_samples << "-noise" << s.noise;
  if (s.left_readout != 0.0 || s.right_readout != 0.0)
    key << "-readout" << s.left_readout << '_' << s.right_readout << 's';
  if (s.liveliness != 0.0) key << "-lively" << s.liveliness;
  if (startOf(s) != 0.0) key << "-start" << startOf(s) << 's';
  if (s.shake.amplitude != 0.0) key << "-shake" << s.shake.frequency << "Hz" << s.shake.amplitude << "rad";
  return key.str();
}

MountShake::MountShake(const WorldSettings& settings, const Eigen::Vector3d& mount)
    : shake_(settings.shake), start_(settings.lead_in_seconds), mount_(mount) {}

Eigen::Isometry3d MountShake::T_body_shaken(double seconds) const {
  constexpr double kFadeIn = 1.0;     // s
  constexpr double kRollShare = 0.6;  // of the amplitude of pitch
  constexpr double kRollPhase = 1.3;  // rad, ahead of pitch
  Eigen::Isometry3d shaken = Eigen::Isometry3d::Identity();
  if (shake_.amplitude == 0.0 || seconds <= start_) return shaken;
  const double t = std::min((seconds - start_) / kFadeIn, 1.0);
  const double fade = t * t * t * (t * (6.0 * t - 15.0) + 10.0);  // zero slope and curvature at both ends
  const double phase = 2.0 * std::numbers::pi * shake_.frequency * (seconds - start_);
  const double pitch = fade * shake_.amplitude * std::sin(phase);
  const double roll = fade * kRollShare * shake_.amplitude * std::sin(phase + kRollPhase);
  const Eigen::Quaterniond turn =
      Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX());
  return Eigen::Translation3d(mount_) * turn * Eigen::Translation3d(-mount_);
}

}  // namespace cartvo::world
