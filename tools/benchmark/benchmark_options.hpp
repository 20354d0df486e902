#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/benchmark/accuracy/accuracy_benchmark.hpp"
#include "tools/benchmark/world_sets.hpp"
#include "tools/cartvo/work_display.hpp"
#include "tools/report/table.hpp"
#include "tools/simulate/stream/stream_cache.hpp"
#include "tools/world/world_settings.hpp"
#include "vo_core/odometry_settings.hpp"

namespace cartvo {

class Command;
class Option;

/// Options that all subcommands of `cartvo benchmark` share.
struct BenchmarkOptions {
  std::filesystem::path data;
  int threads = 2;
  std::string format = "text";
  bool json = false;
  std::filesystem::path output;
  pipeline::AlertLimits limits;

  ReportFormat reportFormat() const;
};

/// Adds --threads, --format, --json and --output. `options` must live as long as the command.
void addReportOptions(Command command, BenchmarkOptions& options);

/// Adds --bitrates-kbps, which sets `bitrates_mbps`, Mbit/s per camera. It must live as long as the
/// command.
void addBitratesOption(Command command, std::vector<double>& bitrates_mbps, const std::string& description);

/// Adds --data, --alert-limits and the options of addReportOptions. `options` must live as long as the
/// command.
void addBenchmarkOptions(Command command, BenchmarkOptions& options);

/// The folder of real sequences: --data, else $CARTVO_DATA, else ../shared/data if it exists. Empty if there
/// is none. Throws std::runtime_error if it is not a folder.
std::filesystem::path dataFolder(const BenchmarkOptions& options);

/// Writes the report to the terminal or to the output file: `json` with the name of the benchmark, versions
/// and threads before it, or `text` in the chosen format. Calls only one of the two functions.
void writeReport(const BenchmarkOptions& options, const char* benchmark,
                 const std::function<nlohmann::ordered_json()>& json,
                 const std::function<std::string(ReportFormat)>& text);

/// Throws std::runtime_error if there are neither real sequences nor worlds.
void requireSequences(const std::filesystem::path& data, const std::vector<world::WorldSettings>& worlds);

inline constexpr const char* kAllScenarios = "all";
inline constexpr const char* kNoScenario = "none";

/// Which rendered worlds are measured; see tools/benchmark/world_sets.hpp.
struct WorldChoice {
  /// Those of the tuning set that are measured unless others are given.
  std::vector<std::string> tuning_scenarios{kAllScenarios};
  std::vector<std::uint64_t> tuning_seeds{benchmark::defaultSeed(benchmark::WorldSet::tuning)};

  std::string set{};                      ///< "tuning", "reporting", or "" for both
  std::vector<std::string> scenarios{};   ///< names of drives, "all", "none"; empty: the default of the set
  std::vector<std::uint64_t> seeds{};     ///< empty: the default of each scenario's set
  double liveliness = 1.0;                ///< of the drives whose names say that they are lively
  std::optional<double> start_seconds{};  ///< see WorldSettings
};

/// Adds --set, --seeds, --liveliness, --start-at and --scenarios, and returns the last. `choice` must live as
/// long as the command.
Option addWorldChoice(Command command, WorldChoice& choice);

/// The worlds of each drive with each seed; other settings have their defaults. Throws std::runtime_error
/// that names the scenario or seed which does not belong to the set.
std::vector<world::WorldSettings> chosenWorlds(const WorldChoice& choice, int threads);

/// A line that says of which set the rendered worlds of a report are; empty if there are none.
std::string worldSetLine(const std::vector<world::WorldSettings>& worlds);

/// Options of rendered drives. Those that begin at standstill start moving half a second later.
struct DriveOptions {
  WorldChoice worlds{.set = "tuning"};
  double seconds = 20.0;
  int features = vo::OdometrySettings{}.features;
  std::filesystem::path cache = simulate::StreamCache::defaultFolder();
};

/// Adds the options of rendered drives. The values of `options` are the defaults; it must live as long as the
/// command.
void addDriveOptions(Command command, DriveOptions& options);

/// The worlds of each scenario with each seed, with synchronised cameras.
std::vector<world::WorldSettings> drivesOf(const DriveOptions& options, int threads);

}  // namespace cartvo
