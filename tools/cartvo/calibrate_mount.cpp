// `cartvo calibrate mount`: how the cameras sit on the cart, from a drive.
#include "tools/cartvo/calibrate_mount.hpp"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>

#include <nlohmann/json.hpp>

#include "calib/rig_file.hpp"
#include "capture/stereo_source.hpp"
#include "tools/calibrate/mount.hpp"
#include "tools/calibrate/mount_source.hpp"
#include "tools/cartvo/progress_bar.hpp"
#include "tools/replay/source_rig.hpp"

namespace cartvo {
namespace {

namespace fs = std::filesystem;
using calibrate::Measured;
using calibrate::Mount;
using calibrate::MountEvidence;

struct Options {
  fs::path source, rig, output;
  double forward = 0.0, left = 0.0;
  bool json = false;
};

constexpr double kDegrees = 180.0 / std::numbers::pi;

std::string line(const char* name, const Measured& measured, double unit, const char* rest) {
  char text[160];
  std::snprintf(text, sizeof text, "%-8s %8.3f +- %.3f %s\n", name, unit * measured.value,
                unit * measured.deviation, rest);
  return text;
}

std::string textOf(const Mount& mount, const MountEvidence& evidence) {
  std::string text =
      line("height", mount.height, 1.0, "m above the ground (left camera)") +
      line("pitch", mount.pitch, kDegrees, mount.pitch.value < 0.0 ? "deg, looks up" : "deg, looks down") +
      line("roll", mount.roll, kDegrees,
           mount.roll.value < 0.0 ? "deg, right side higher" : "deg, left side higher");
  if (mount.yaw) {
    text += line("yaw", *mount.yaw, kDegrees,
                 mount.yaw->value < 0.0 ? "deg, looks to the right" : "deg, looks to the left");
  } else {
    text += "yaw      not measured: the cart did not drive faster than 1 m/s; kept as it was\n";
  }
  if (mount.ahead_of_axle)
    text += line("ahead", *mount.ahead_of_axle, 1.0, "m, of the rear axle, as bends tell (not written)");
  return text + "from " + std::to_string(mount.sightings) + " looks at the ground and " +
         std::to_string(mount.motions) + " motions in " + std::to_string(evidence.pairs) + " pairs\n";
}

nlohmann::ordered_json jsonOf(const Mount& mount, const MountEvidence& evidence) {
  const auto both = [](const Measured& measured, double unit) {
    return nlohmann::ordered_json{{"value", unit * measured.value}, {"deviation", unit * measured.deviation}};
  };
  nlohmann::ordered_json json{{"height_m", both(mount.height, 1.0)},
                              {"pitch_deg", both(mount.pitch, kDegrees)},
                              {"roll_deg", both(mount.roll, kDegrees)},
                              {"yaw_deg", nullptr},
                              {"ahead_of_axle_m", nullptr},
                              {"sightings", mount.sightings},
                              {"motions", mount.motions},
                              {"pairs", evidence.pairs}};
  if (mount.yaw) json["yaw_deg"] = both(*mount.yaw, kDegrees);
  if (mount.ahead_of_axle) json["ahead_of_axle_m"] = both(*mount.ahead_of_axle, 1.0);
  return json;
}

void run(const Options& options, bool gives_forward, bool gives_left) {
  Rig rig = findRig(openSource(options.source), options.source, options.rig).rig;
  if (gives_forward) rig.T_body_camera.translation().x() = options.forward;
  if (gives_left) rig.T_body_camera.translation().y() = options.left;
  MountEvidence evidence;
  {
    ProgressBar progress("pairs");
    evidence = calibrate::gatherMountEvidence(
        options.source, rig, [&](std::size_t done, std::size_t expected) { progress.show(done, expected); });
  }
  const Mount mount = calibrate::measureMount(evidence.sightings, evidence.motions, rig.T_body_camera);
  rig.T_body_camera = mount.T_body_camera;
  writeRig(options.output, rig);
  const std::string report = options.json ? jsonOf(mount, evidence).dump(2) + "\n" : textOf(mount, evidence);
  std::fputs(report.c_str(), stdout);
  if (!options.json) std::printf("written to %s\n", options.output.c_str());
}

}  // namespace

void addCalibrateMount(CLI::App& calibrate) {
  CLI::App* command = calibrate.add_subcommand(
      "mount", "Height, pitch, roll and yaw of the cameras on the cart, from a drive");
  const auto options = std::make_shared<Options>();
  command
      ->add_option("SOURCE", options->source,
                   "A recording (cartvod --record), or a folder in KITTI's or EuRoC's layout")
      ->required();
  command->add_option("--output", options->output, "Rig file to write; may be the one that was read")
      ->required()
      ->type_name("FILE");
  command->add_option("--rig", options->rig, "Rig file (default: the source's own)")->type_name("FILE");
  CLI::Option* forward =
      command
          ->add_option("--forward", options->forward,
                       "How far ahead of the rear axle the left camera is, m (default: the rig file's)")
          ->check(CLI::Range(-10.0, 10.0));
  CLI::Option* left = command
                          ->add_option("--left", options->left,
                                       "How far left of the cart's middle it is, m (default: the rig file's)")
                          ->check(CLI::Range(-10.0, 10.0));
  command->add_flag("--json", options->json, "Report as JSON");
  command->footer(
      "Drive straight on level ground for some twenty seconds, faster than walking; with cameras that are "
      "not\n"
      "synchronised stand for a few seconds first.\n"
      "Example:\n"
      "  cartvo calibrate mount recordings/first --output rig.yaml --forward 1.55 --left 0.06");
  command->callback([options, forward, left] { run(*options, forward->count() > 0, left->count() > 0); });
}

}  // namespace cartvo
