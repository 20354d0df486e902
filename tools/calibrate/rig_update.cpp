// Options of commands that write what they measure to a rig file, and the rig to start from.
#include "tools/calibrate/rig_update.hpp"

#include <stdexcept>

#include "calib/format/rig_file.hpp"
#include "capture/stereo_source.hpp"
#include "common/command_line/parser.hpp"
#include "pipeline/source_rig.hpp"

namespace cartvo::calibrate {

bool RigUpdateOptions::isSingleVideo() const {
  return right_video.empty() && std::filesystem::is_regular_file(source);
}

void addRigUpdateOptions(Command command, RigUpdateOptions& options, const std::string& source_text,
                         const std::string& output_text) {
  command.addOption("SOURCE", options.source, source_text).required();
  command.addOption("RIGHT", options.right_video, "The right camera's video, if SOURCE is the left one's");
  command.addOption("--output", options.output, output_text).typeName("FILE");
  command
      .addOption("--rig", options.rig, "Rig file to start from (default: FILE of --output, or the source's)")
      .typeName("FILE");
  command
      .addOption("--frame-rate", options.frame_rate,
                 "Frame rate of the cameras: replaces the time stamps of videos and of a folder; needed for "
                 "raw streams (.h264)")
      .range(0.5, 1000.0)
      .typeName("HZ");
  command.addFlag("--json", options.json, "Report as JSON");
}

calib::Rig rigToChange(const RigUpdateOptions& options, bool is_live) {
  if (!options.rig.empty()) return calib::readRig(options.rig);
  if (std::filesystem::exists(options.output)) return calib::readRig(options.output);
  if (is_live || std::filesystem::is_regular_file(options.source))
    throw std::runtime_error(options.output.string() + ": does not exist; give the rig file with --rig FILE");
  return pipeline::findRig(capture::openSource(options.source), options.source, {}).rig;
}

}  // namespace cartvo::calibrate
