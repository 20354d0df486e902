// Combines path, campus, drive, traffic, cameras and light into simulated images with ground truth.
#include "lab/render/rendered_world.hpp"

#include <array>
#include <cmath>
#include <mutex>
#include <optional>
#include <sstream>
#include <stdexcept>

#include <opencv2/core.hpp>

#include "lab/render/motion/drive.hpp"
#include "lab/render/motion/mount_shake.hpp"
#include "lab/render/motion/wind.hpp"
#include "lab/render/scenario_traits.hpp"
#include "lab/render/scene/campus.hpp"
#include "lab/render/scene/steps.hpp"
#include "lab/render/scene/traffic.hpp"
#include "lab/render/surface/hash.hpp"
#include "lab/render/tracing/lens.hpp"
#include "lab/render/tracing/lens_drops.hpp"
#include "lab/render/tracing/photometry.hpp"
#include "lab/render/tracing/renderer.hpp"
#include "lab/render/tracing/scene.hpp"
#include "lab/render/tracing/veiling_glare.hpp"

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

class RenderedWorld::Implementation {
 public:
  explicit Implementation(const WorldSettings& wanted)
      : settings(validated(wanted)),
        rig(simulatedRig(settings)),
        path(campusPath(settings)),
        drive(path, settings),
        lighting(buildLighting(settings, path)),
        style(styleOf(settings)),
        rays{RayTable(rig.left), RayTable(rig.right)},
        meter_model(meterModel(rig.left)),
        meter_rays(meter_model),
        T_body_camera{rig.T_body_camera, rig.T_body_camera * rig.T_right_left.inverse()},
        shake(settings, 0.5 * (T_body_camera[0].translation() + T_body_camera[1].translation())),
        T_start_map(T_map_body(0.0).inverse()) {}

  /// Instant of the drive, s, at `seconds` after the content's start.
  double driveInstant(double seconds) const { return startOf(settings) + seconds; }

  Eigen::Isometry3d T_map_body(double seconds) const {
    return drive.T_map_body(driveInstant(seconds)) * shake.T_body_shaken(driveInstant(seconds));
  }

  double readout(std::size_t camera) const {
    return camera == 0 ? settings.left_readout : settings.right_readout;
  }

  double instant(int index, capture::CameraSide side) const {
    const double period = 1.0 / settings.frame_rate;
    if (side == capture::CameraSide::left) return index * period;
    return settings.offset_s + index * period * (1.0 + 1e-6 * settings.offset_drift_ppm);
  }
  std::int64_t instantNs(int index, capture::CameraSide side) const {
    return std::llround(1e9 * instant(index, side));
  }

  cv::Mat image(int index, capture::CameraSide side) {
    const std::lock_guard lock(mutex);
    meterExposure();
    const std::size_t camera = sideIndex(side);
    const double seconds = 1e-9 * static_cast<double>(instantNs(index, side));
    const std::uint32_t image_seed =
        hashOf({static_cast<std::uint32_t>(settings.seed), static_cast<std::uint32_t>(index),
                static_cast<std::uint32_t>(camera)});
    SensorSettings sensor;
    sensor.gain = camera == 0 ? 1.0F : 1.03F;
    const calib::CameraModel& model = camera == 0 ? rig.left : rig.right;
    sensor.vignette_centre = cv::Point2f(static_cast<float>(model.cx), static_cast<float>(model.cy));
    sensor.vignette = camera == 0 ? 0.30F : 0.33F;
    sensor.noise = static_cast<float>(settings.noise);
    return exposeImage(radianceAt(seconds, camera), exposure->exposure(seconds), sensor,
                       mixBits(image_seed + 17U), settings.threads);
  }

  cv::Mat radiance(int index, capture::CameraSide side) {
    const std::lock_guard lock(mutex);
    buildSceneState();
    return radianceAt(1e-9 * static_cast<double>(instantNs(index, side)), sideIndex(side));
  }

  DepthImage depth(int index, capture::CameraSide side) {
    const std::lock_guard lock(mutex);
    const std::size_t camera = sideIndex(side);
    const double seconds = 1e-9 * static_cast<double>(instantNs(index, side));
    buildSceneState();
    moveTo(seconds, readout(camera));
    DepthImage result;
    renderDepthAndMotion(scene_state->scene, RenderSettings{0, settings.threads}, rowViewAt(seconds, camera),
                         result.depth, result.moving);
    return result;
  }

  double meanRadiance(double seconds) {
    const std::lock_guard lock(mutex);
    buildSceneState();
    return meanRadianceAt(seconds);
  }

 private:
  /// The part of the world that images need and the truth does not; expensive to build.
  struct SceneState {
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

  void buildSceneState() {
    if (scene_state == nullptr) scene_state = std::make_unique<SceneState>(path, drive, settings);
  }

  /// Moves the objects to their places within a readout whose middle is at `seconds`.
  void moveTo(double seconds, double readout) {
    Scene& scene = scene_state->scene;
    for (int step = 0; step < scene.timeSteps(); ++step) {
      const double share = scene.timeSteps() == 1 ? 0.0 : static_cast<double>(step) / (kTimeSteps - 1) - 0.5;
      const double instant = driveInstant(seconds + share * readout);
      scene_state->traffic.placeAt(instant, scene_state->campus.instances);
      scene_state->wind.placeAt(instant, scene_state->campus.instances);
      scene.place(step);
    }
    scene.update();
  }

  /// A camera all of whose rows are exposed at `seconds`.
  View viewAt(double seconds, const RayTable& table, std::size_t camera) const {
    const Eigen::Isometry3d T_map_camera = T_map_body(seconds) * T_body_camera[camera];
    View view;
    view.rays = &table;
    view.size = settings.image_size;
    view.T_map_camera = {T_map_camera.cast<float>()};
    view.sample_seed = samplePatternSeed(T_map_camera);
    return view;
  }

  /// A camera whose middle row is exposed at `seconds` and each row at its own instant.
  View rowViewAt(double seconds, std::size_t camera) const {
    View view = viewAt(seconds, rays[camera], camera);
    if (readout(camera) == 0.0) return view;
    view.T_map_camera.clear();
    for (int row = 0; row < view.size.height; ++row) {
      const double instant = seconds + readout(camera) * rowShare(row, view.size.height);
      view.T_map_camera.emplace_back((T_map_body(instant) * T_body_camera[camera]).cast<float>());
    }
    return view;
  }

  cv::Mat radianceAt(double seconds, std::size_t camera) {
    moveTo(seconds, readout(camera));
    const RenderSettings sampling{settings.edge_samples, settings.threads};
    cv::Mat radiance =
        renderRadiance(scene_state->scene, lighting, style, sampling, rowViewAt(seconds, camera));
    addVeilingGlare(radiance, (camera == 0 ? rig.left : rig.right).fx);
    if (traitsOf(settings.scenario).drops_on_lens)
      addLensDrops(radiance,
                   hashOf({static_cast<std::uint32_t>(settings.seed), static_cast<std::uint32_t>(camera)}));
    return radiance;
  }

  /// Mean radiance of the left camera's view.
  double meanRadianceAt(double seconds) {
    moveTo(seconds, 0.0);
    View view = viewAt(seconds, meter_rays, 0);
    view.size = meter_model.size;
    cv::Mat radiance =
        renderRadiance(scene_state->scene, lighting, style, RenderSettings{0, settings.threads}, view);
    addVeilingGlare(radiance, meter_model.fx);
    return cv::mean(cv::min(radiance, kMaxMeteredRadiance))[0];
  }

  /// Builds the scene and meters the radiance over the drive, once.
  void meterExposure() {
    buildSceneState();
    if (exposure) return;
    std::vector<double> metered;
    for (const double t : stepsBelow(settings.seconds + 1.0, 0.0, ExposureControl::kMeterStep))
      metered.push_back(meanRadianceAt(t));
    exposure.emplace(settings, metered);
  }

 public:
  const WorldSettings settings;
  const calib::Rig rig;
  const Path path;
  const Drive drive;
  const Lighting lighting;
  const TextureStyle style;
  const std::array<RayTable, 2> rays;
  const calib::CameraModel meter_model;
  const RayTable meter_rays;
  const std::array<Eigen::Isometry3d, 2> T_body_camera;
  const MountShake shake;
  const Eigen::Isometry3d T_start_map;
  std::unique_ptr<SceneState> scene_state;  ///< built with the first image
  std::optional<ExposureControl> exposure;  ///< metered with the first image
  std::mutex mutex;  ///< guards scene_state and exposure; the scene is moved for each image
};

RenderedWorld::RenderedWorld(const WorldSettings& settings)
    : implementation_(std::make_unique<Implementation>(settings)) {}

RenderedWorld::~RenderedWorld() = default;

calib::Rig RenderedWorld::rig() const {
  return implementation_->rig;
}

double RenderedWorld::frameRate() const {
  return implementation_->settings.frame_rate;
}

int RenderedWorld::pairCount() const {
  return std::max(1, static_cast<int>(std::floor(implementation_->settings.seconds * frameRate())));
}

std::int64_t RenderedWorld::leftInstant(int index) const {
  return implementation_->instantNs(index, capture::CameraSide::left);
}

std::int64_t RenderedWorld::rightInstant(int index) const {
  return implementation_->instantNs(index, capture::CameraSide::right);
}

double RenderedWorld::rowInstant(int index, capture::CameraSide side, double row) const {
  return 1e-9 * static_cast<double>(implementation_->instantNs(index, side)) +
         implementation_->readout(sideIndex(side)) *
             rowShare(row, implementation_->settings.image_size.height);
}

void RenderedWorld::images(int index, cv::Mat& left, cv::Mat& right) const {
  left = image(index, capture::CameraSide::left);
  right = image(index, capture::CameraSide::right);
}

const WorldSettings& RenderedWorld::settings() const {
  return implementation_->settings;
}

cv::Mat RenderedWorld::image(int index, capture::CameraSide side) const {
  return implementation_->image(index, side);
}

cv::Mat RenderedWorld::radiance(int index, capture::CameraSide side) const {
  return implementation_->radiance(index, side);
}

DepthImage RenderedWorld::renderDepth(int index, capture::CameraSide side) const {
  return implementation_->depth(index, side);
}

double RenderedWorld::meanRadiance(double seconds) const {
  return implementation_->meanRadiance(seconds);
}

Eigen::Isometry3d RenderedWorld::T_world_body(double seconds) const {
  return implementation_->T_start_map * implementation_->T_map_body(seconds);
}

bool RenderedWorld::startsAtStandstill() const {
  return implementation_->drive.speed(implementation_->driveInstant(0.0)) == 0.0;
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
  const WorldSettings& s = implementation_->settings;
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

}  // namespace cartvo::world
