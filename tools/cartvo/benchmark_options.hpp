#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "tools/benchmark/accuracy_benchmark.hpp"
#include "tools/cartvo/progress_bar.hpp"
#include "tools/report/table.hpp"
#include "tools/simulate/stream_cache.hpp"
#include "tools/world/world_settings.hpp"
#include "vo_core/odometry_settings.hpp"

namespace cartvo {

/// What all of `cartvo benchmark` can be asked for.
struct BenchmarkOptions {
  std::filesystem::path data;
  int threads = 2;
  std::string format = "text";
  std::filesystem::path output;

  ReportFormat reportFormat() const;
};

/// Adds --threads, --format and --output. `options` must live as long as the command.
void addReportOptions(CLI::App& command, BenchmarkOptions& options);

/// The same and --data.
void addBenchmarkOptions(CLI::App& command, BenchmarkOptions& options);

/// The folder of real sequences: --data, else $CARTVO_DATA, else ../shared/data if it is there; empty: none.
/// Throws std::runtime_error if it is no folder.
std::filesystem::path dataFolder(const BenchmarkOptions& options);

/// Throws std::runtime_error, before the work, if the folder of a file that will be written is not there. An
/// empty name is fine.
void checkOutput(const std::filesystem::path& file);

/// Writes the report as it was asked for, to the terminal or into the file: `json`, behind the benchmark's
/// name, versions and threads, or `text` in that format. Only the one wanted is called.
void handReport(const BenchmarkOptions& options, const char* benchmark,
                const std::function<nlohmann::ordered_json()>& json,
                const std::function<std::string(ReportFormat)>& text);

/// Throws std::runtime_error if there are neither real sequences nor worlds.
void requireSequences(const std::filesystem::path& data, const std::vector<world::WorldSettings>& worlds);

inline constexpr const char* kAllScenarios = "all";
inline constexpr const char* kNoScenario = "none";

/// Adds --scenarios and --seeds; returns the former. What they are read into must live as long as the
/// command.
CLI::Option* addWorldChoice(CLI::App& command, std::vector<std::string>& scenarios,
                            std::vector<std::uint64_t>& seeds);

/// Each scenario with each seed, else as WorldSettings are. `scenarios` must be what --scenarios takes: names
/// of scenarios, "all", "none".
std::vector<world::WorldSettings> chosenWorlds(const std::vector<std::string>& scenarios,
                                               const std::vector<std::uint64_t>& seeds, int threads);

/// Rendered drives that start half a second after the first pair: a cart that stands tells little.
struct DriveOptions {
  std::vector<std::string> scenarios;
  std::vector<std::uint64_t> seeds{1};
  double seconds = 20.0;
  int features = OdometrySettings{}.features;
  std::filesystem::path cache = simulate::StreamCache::defaultFolder();
};

/// `options`, whose values are the defaults, must live as long as the command.
void addDriveOptions(CLI::App& command, DriveOptions& options);

/// Each scenario with each seed, cameras exposed at once.
std::vector<world::WorldSettings> drivesOf(const DriveOptions& options, int threads);

/// A line on the error output for each piece of work, and a bar below it while it goes on.
class WorkDisplay {
 public:
  benchmark::WorkObserver observer();

 private:
  std::optional<ProgressBar> bar_;
};

}  // namespace cartvo
