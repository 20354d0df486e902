// Options of commands that write what they measure to a rig file, and the rig to start from.
#include "tools/calibrate/rig_update.hpp"

#include <stdexcept>

#include <CLI/CLI.hpp>

#include "calib/format/rig_file.hpp"
#include "capture/stereo_source.hpp"
#include "daemon/pipeline/source_rig.hpp"

namespace cartvo::calibrate {

bool RigUpdateOptions::isSingleVideo() const {
  return right_video.empty() && std::filesystem::is_regular_file(source);
}

void addRigUpdateOptions(CLI::App& command, RigUpdateOptions& options, const std::string& source_text,
                         const std::string& output_text) {
  command.add_option("SOURCE", options.source, source_text)->required();
  command.add_option("RIGHT", options.right_video, "The right camera's video, if SOURCE is the left one's");
  command.add_option("--output", options.output, output_text)->type_name("FILE");
  command
      .add_option("--rig", options.rig, "Rig file to start from (default: FILE of --output, or the source's)")
      ->type_name("FILE");
  command
      .add_option("--frame-rate", options.frame_rate,
                  "Frame rate of the cameras: replaces the time stamps of videos and of a folder; needed for "
                  "raw streams (.h264)")
      ->check(CLI::Range(0.5, 1000.0))
      ->type_name("HZ");
  command.add_flag("--json", options.json, "Report as JSON");
}

calib::Rig rigToChange(const RigUpdateOptions& options, bool is_live) {
  if (!options.rig.empty()) return calib::readRig(options.rig);
  if (std::filesystem::exists(options.output)) return calib::readRig(options.output);
  if (is_live || std::filesystem::is_regular_file(options.source))
    throw std::runtime_error(options.output.string() + ": does not exist; give the rig file with --rig FILE");
  return daemon::findRig(capture::openSource(options.source), options.source, {}).rig;
}

}  // namespace cartvo::calibrate
