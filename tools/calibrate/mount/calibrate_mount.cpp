// `cartvo calibrate mount`: estimates the cameras' mounting on the cart from a drive.
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include <nlohmann/json.hpp>

#include "calib/format/rig_file.hpp"
#include "calib/model/rig.hpp"
#include "calib/rectification/rectification_tables.hpp"
#include "calib/rectification/rectifier.hpp"
#include "capture/stereo_source.hpp"
#include "common/command_line/parser.hpp"
#include "common/units.hpp"
#include "pipeline/body_motion.hpp"
#include "pipeline/pair_processor.hpp"
#include "pipeline/source_rig.hpp"
#include "tools/calibrate/mount/ground_plane.hpp"
#include "tools/calibrate/mount/mount.hpp"
#include "tools/calibrate/source_pairs.hpp"
#include "tools/calibrate/subcommands.hpp"
#include "tools/cartvo/json_text.hpp"
#include "tools/cartvo/progress_bar.hpp"
#include "tools/cartvo/result_files.hpp"

namespace cartvo::calibrate {
namespace {

// Ground observations and motions from a recording, for the mount.

/// Measurements for measureMount from a source, in the axes of the rig's left camera.
struct MountMeasurements {
  std::vector<GroundObservation> ground;
  std::vector<CameraTwist> motions;
  std::size_t pairs = 0;
  std::size_t unsynchronised =
      0;  ///< pairs not searched for the ground, since the cart moved between the exposures
};

/// Called with the number of pairs processed and the number expected (0: unknown).
using MountProgress = std::function<void(std::size_t done, std::size_t expected)>;

constexpr double kObservationInterval = 0.25;  // s
constexpr double kMaxDisplacement = 0.001;     // m, between the two exposures of a pair

double secondsOf(std::int64_t instant_ns) {
  return 1e-9 * static_cast<double>(instant_ns);
}

/// The mean twist of the left camera since the previous pair, in its own axes.
std::optional<CameraTwist> twistOf(const pipeline::PairResult& result,
                                   const Eigen::Matrix3d& R_left_rectified) {
  const vo::OdometryEstimate& estimate = result.estimate;
  if (!estimate.valid || estimate.time_step <= 0.0) return std::nullopt;
  const vo::Vector6d twist = pipeline::logarithm(estimate.T_previous_current) / estimate.time_step;
  return CameraTwist{secondsOf(estimate.exposure_ns), R_left_rectified * twist.head<3>(),
                     R_left_rectified * twist.tail<3>()};
}

std::optional<GroundPlane> groundOf(const capture::FramePair& pair, const calib::Rectifier& rectifier) {
  cv::Mat left, right;
  rectifier.rectifyLeft(pair.left.image, left);
  rectifier.rectifyRight(pair.right.image, right);
  return findGround(left, right, rectifier.rectification());
}

/// Collects the measurements, pair by pair.
class MountMeasurementCollector {
 public:
  MountMeasurementCollector(const calib::Rig& rig, pipeline::AbsentReadout absent_readout)
      : processor_(rig, {rig, rig.rectification, calib::buildTables(rig, rig.rectification)},
                   {.absent_readout = absent_readout}),
        R_left_rectified_(processor_.T_left_rectified().linear()) {}

  void add(const capture::FramePair& pair) {
    const std::optional<CameraTwist> twist = twistOf(processor_.process(pair), R_left_rectified_);
    ++measurements.pairs;
    if (!twist) return;
    measurements.motions.push_back(*twist);
    const double seconds = secondsOf(pair.left.exposure_ns);
    if (next_observation_ && seconds < *next_observation_) return;
    if (std::abs(secondsOf(pair.offsetNs())) * twist->velocity.norm() > kMaxDisplacement) {
      ++measurements.unsynchronised;
      return;
    }
    next_observation_ = seconds + kObservationInterval;
    if (const std::optional<GroundPlane> ground = groundOf(pair, processor_.rectifier()))
      measurements.ground.push_back({seconds, R_left_rectified_ * ground->down, ground->height});
  }

  MountMeasurements measurements;

 private:
  pipeline::PairProcessor processor_;
  Eigen::Matrix3d R_left_rectified_;
  std::optional<double> next_observation_;  ///< s
};

/// Runs the odometry over a recording or a folder of images, and searches for the ground some times a second,
/// in pairs between whose exposures the cart moves less than a millimetre. Throws std::runtime_error for a
/// source without pairs, and the exceptions of openSource and of the rectification.
MountMeasurements collectMountMeasurements(const std::filesystem::path& source, const calib::Rig& rig,
                                           const MountProgress& progress) {
  capture::StereoSource pairs = capture::openSource(source);
  MountMeasurementCollector collector(rig, pipeline::absentReadoutOf(pairs.kind));
  forEachPair(pairs, [&](const capture::FramePair& pair) {
    collector.add(pair);
    progress(collector.measurements.pairs, pairs.pairs);
    return true;
  });
  if (collector.measurements.pairs == 0)
    throw std::runtime_error(source.string() + ": holds no pair of images that belong together");
  return collector.measurements;
}

}  // namespace
}  // namespace cartvo::calibrate

namespace cartvo {
namespace {

namespace fs = std::filesystem;
using calibrate::Estimate;
using calibrate::Mount;
using calibrate::MountMeasurements;

struct Options {
  fs::path source, rig, output;
  double forward = 0.0, left = 0.0;
  bool json = false;
};

std::string line(const char* name, const Estimate& estimate, double unit, const char* rest) {
  char text[160];
  std::snprintf(text, sizeof text, "%-8s %8.3f +- %.3f %s\n", name, unit * estimate.value,
                unit * estimate.stddev, rest);
  return text;
}

std::string textOf(const Mount& mount, const MountMeasurements& measurements) {
  std::string text = line("height", mount.height, 1.0, "m above the ground (left camera)") +
                     line("pitch", mount.pitch, kDegreesPerRadian,
                          mount.pitch.value < 0.0 ? "deg, looks up" : "deg, looks down") +
                     line("roll", mount.roll, kDegreesPerRadian,
                          mount.roll.value < 0.0 ? "deg, right side higher" : "deg, left side higher");
  if (mount.yaw) {
    text += line("yaw", *mount.yaw, kDegreesPerRadian,
                 mount.yaw->value < 0.0 ? "deg, looks to the right" : "deg, looks to the left");
  } else {
    text += "yaw      not measured: the cart did not drive faster than 1 m/s; unchanged\n";
  }
  if (mount.ahead_of_axle)
    text += line("ahead", *mount.ahead_of_axle, 1.0, "m, of the rear axle, measured in curves (not written)");
  return text + "from " + std::to_string(mount.ground_observations) + " observations of the ground and " +
         std::to_string(mount.motions) + " motions in " + std::to_string(measurements.pairs) + " pairs\n";
}

nlohmann::ordered_json jsonOf(const Mount& mount, const MountMeasurements& measurements) {
  const auto both = [](const Estimate& estimate, double unit) {
    return nlohmann::ordered_json{{"value", unit * estimate.value}, {"deviation", unit * estimate.stddev}};
  };
  nlohmann::ordered_json json{{"height_m", both(mount.height, 1.0)},
                              {"pitch_deg", both(mount.pitch, kDegreesPerRadian)},
                              {"roll_deg", both(mount.roll, kDegreesPerRadian)},
                              {"yaw_deg", nullptr},
                              {"ahead_of_axle_m", nullptr},
                              {"sightings", mount.ground_observations},
                              {"motions", mount.motions},
                              {"pairs", measurements.pairs}};
  if (mount.yaw) json["yaw_deg"] = both(*mount.yaw, kDegreesPerRadian);
  if (mount.ahead_of_axle) json["ahead_of_axle_m"] = both(*mount.ahead_of_axle, 1.0);
  return json;
}

void run(const Options& options, bool gives_forward, bool gives_left) {
  checkResultFiles({options.output});
  calib::Rig rig = pipeline::findRig(capture::openSource(options.source), options.source, options.rig).rig;
  if (gives_forward) rig.T_body_camera.translation().x() = options.forward;
  if (gives_left) rig.T_body_camera.translation().y() = options.left;
  MountMeasurements measurements;
  {
    ProgressBar progress("pairs");
    measurements = calibrate::collectMountMeasurements(
        options.source, rig, [&](std::size_t done, std::size_t expected) { progress.show(done, expected); });
  }
  const double seconds = calibrate::durationOf(measurements.ground);
  const Mount mount = calibrate::withRoadUncertainty(
      calibrate::measureMount(measurements.ground, measurements.motions, rig.T_body_camera), seconds);
  rig.T_body_camera = mount.T_body_camera;
  calib::writeRig(options.output, rig);
  const std::string report =
      options.json ? jsonText(jsonOf(mount, measurements)) : textOf(mount, measurements);
  std::fputs(report.c_str(), stdout);
  if (!options.json) std::printf("written to %s\n", options.output.c_str());
  constexpr double kEnough_s = 15.0;
  if (seconds < kEnough_s) {
    std::fprintf(stderr, "cartvo: the ground was seen for %.0f s only; drive for about twenty seconds\n",
                 seconds);
  }
  for (const auto& [axis, option, place] : {std::tuple{0, "--forward", "ahead of the rear axle"},
                                            std::tuple{1, "--left", "left of the cart's middle"}}) {
    if (rig.T_body_camera.translation()[axis] != 0.0 || (axis == 0 ? gives_forward : gives_left)) continue;
    std::fprintf(stderr, "cartvo: the left camera counts as 0 m %s: measure it and give %s METRES\n", place,
                 option);
  }
}

}  // namespace

void addCalibrateMount(Command calibrate) {
  const Command command = calibrate.addSubcommand(
      "mount", "Height, pitch, roll and yaw of the cameras on the cart, from a drive");
  const auto options = std::make_shared<Options>();
  command
      .addOption("SOURCE", options->source,
                 "A recording (cartvod --record), or a folder in KITTI's or EuRoC's layout")
      .required();
  command.addOption("--output", options->output, "Rig file to write; may be the input file")
      .required()
      .typeName("FILE");
  command.addOption("--rig", options->rig, "Rig file (default: the source's)").typeName("FILE");
  const Option forward =
      command
          .addOption("--forward", options->forward,
                     "Distance of the left camera ahead of the rear axle, m (default: from the rig file)")
          .range(-10.0, 10.0);
  const Option left =
      command
          .addOption("--left", options->left,
                     "Distance of the left camera left of the cart's middle, m (default: from the rig file)")
          .range(-10.0, 10.0);
  command.addFlag("--json", options->json, "Report as JSON");
  command.footer(
      "Drive straight on level ground for about twenty seconds, faster than walking. If the cameras are not\n"
      "synchronised, begin with a standstill of a few seconds.\n"
      "Example:\n"
      "  cartvo calibrate mount recordings/first --output rig.yaml --forward 1.55 --left 0.06");
  command.callback([options, forward, left] { run(*options, forward.count() > 0, left.count() > 0); });
}

}  // namespace cartvo
