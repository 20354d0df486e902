#pragma once

#include <filesystem>
#include <string>

#include "calib/model/rig.hpp"

namespace cartvo {
class Command;
}  // namespace cartvo

namespace cartvo::calibrate {

/// Command line of a command that measures something of two cameras and writes it to a rig file.
struct RigUpdateOptions {
  std::filesystem::path source, right_video, rig, output;
  double frame_rate = 0.0;  ///< Hz; 0: that of the source
  bool json = false;

  /// Whether the source is the video of one camera.
  bool isSingleVideo() const;
};

/// Adds the options. `source_text` and `output_text` describe SOURCE and --output.
void addRigUpdateOptions(Command command, RigUpdateOptions& options, const std::string& source_text,
                         const std::string& output_text);

/// The rig file to change: that of --rig, or the output if it exists, or that of the source, which then must
/// be a folder and not `is_live`. Throws std::runtime_error that names the file.
calib::Rig rigToChange(const RigUpdateOptions& options, bool is_live = false);

}  // namespace cartvo::calibrate
