#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/simulate/stream/stream_cache.hpp"
#include "tools/simulate/stream/stream_encoder.hpp"

namespace cartvo {

class Command;

/// Command-line options of `cartvo simulate`.
struct SimulateOptions {
  std::string world = "campus";
  std::filesystem::path sequence;
  std::filesystem::path recording;
  double seconds = 0.0;      ///< 0: the content's own length
  double frame_rate = 18.0;  ///< of a rendered drive, Hz
  std::optional<double> offset_ms;
  std::optional<double> offset_drift_ppm;
  /// Further options that cartvo-render reads, by their names, as they were given; empty: not given.
  std::map<std::string, std::string> rendering;

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

/// The options of cartvo-render for the drive, without its folder.
std::vector<std::string> rendererArguments(const SimulateOptions& options);

/// Adds the options to `command`; `options` must outlive it. Returns whether a parsed command line names the
/// content, with any of its options.
std::function<bool()> addSimulateOptions(Command command, SimulateOptions& options);

}  // namespace cartvo
