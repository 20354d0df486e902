#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include <opencv2/core/types.hpp>

#include "lab/render/world_settings.hpp"
#include "tools/cartvo/readout_option.hpp"
#include "tools/simulate/stream/stream_cache.hpp"
#include "tools/simulate/stream/stream_encoder.hpp"

namespace cartvo {

class Command;

/// A drive that is rendered in a minute: about two pairs a second on two cores.
inline world::WorldSettings shortDrive() {
  constexpr double kSeconds = 6.0;
  world::WorldSettings drive;
  drive.seconds = kSeconds;
  return drive;
}

/// Command-line options of `cartvo simulate`.
struct SimulateOptions {
  std::string world = "campus";
  std::filesystem::path sequence;
  std::filesystem::path recording;
  double seconds = 0.0;  ///< 0: the content's own length
  world::WorldSettings drive = shortDrive();
  std::string size = "680x420";
  std::optional<double> offset_ms;         ///< empty: see cameraTiming
  std::optional<double> offset_drift_ppm;  ///< empty: see cameraTiming
  std::string readout_ms;                  ///< empty: see cameraTiming
  double shake_degrees = 0.0;

  std::string left_address = "127.0.0.1:8554";
  std::string right_address = "127.0.0.1:8555";
  std::string user = "admin";
  std::filesystem::path password_file;
  simulate::EncoderSettings encoder;
  double lead_in = 3.0;
  double latency_ms = 0.0;
  bool start_when_watched = false;
  bool loop = false;

  std::filesystem::path output = "simulation";
  std::filesystem::path cache_dir = simulate::StreamCache::defaultFolder();
  double cache_gigabytes = 4.0;
  bool no_cache = false;
  bool prepare_only = false;
  bool render = false;
  bool encode = false;

  /// Whether cameras are served: not if only files are made.
  bool serves() const { return !prepare_only && !render && !encode; }
};

/// Parses WIDTHxHEIGHT. Throws std::invalid_argument that quotes the text.
cv::Size parseSize(const std::string& text);

/// When two cameras expose their images and rows.
struct CameraTiming {
  double offset_ms = 0.0;         ///< right minus left exposure at the start
  double offset_drift_ppm = 0.0;  ///< relative excess of the right camera's period, 1e-6
  Readouts readouts;
};

/// The timing of the options. By default rendered cameras are as users' cameras: they run free, such that the
/// offset passes through a whole frame period from minus a quarter of it (through as much as 10000 ppm permit
/// in a short drive), and read their rows in 32 ms, or in 0.96 of a shorter frame period. If one of offset
/// and drift is given, the other is 0. A recorded sequence has neither by default. Throws
/// std::invalid_argument if the readouts are no numbers.
CameraTiming cameraTiming(const SimulateOptions& options);

/// Adds the options to `command`; `options` must outlive it. Returns whether a parsed command line names the
/// content, with any of its options.
std::function<bool()> addSimulateOptions(Command command, SimulateOptions& options);

}  // namespace cartvo
