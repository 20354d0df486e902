// Command line of `cartvo watch`.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "common/atomic_file.hpp"
#include "common/command_line/parser.hpp"
#include "tools/cartvo/commands.hpp"
#include "tools/cartvo/result_files.hpp"
#include "tools/cartvo/time_option.hpp"
#include "tools/watch/watch.hpp"

namespace cartvo {
namespace {

struct Options {
  WatchSettings watch;
  std::filesystem::path output;  ///< folder; empty: none
  bool json = false;
  std::optional<double> required_percent;
};

void run(const Options& options) {
  const std::filesystem::path trajectory = options.output / "trajectory.tum",
                              summary_file = options.output / "summary.json";
  if (!options.output.empty()) checkResultFiles({trajectory, summary_file});
  const OdometryStatistics statistics = watchOdometry(options.watch);
  const OdometrySummary summary = statistics.summarise();
  const std::string json = summaryJson(summary);
  std::fputs((options.json ? json : summaryText(summary)).c_str(), stdout);
  if (!options.output.empty()) {
    writeTum(trajectory, statistics.trajectory(), TrajectoryFrame::body);
    writeResultFile(summary_file, json);
  }
  if (options.required_percent && validPercent(summary) < *options.required_percent) {
    char text[120];
    std::snprintf(text, sizeof text, "%.1f %% of the pairs were valid, --require-valid asks for %.1f %%",
                  validPercent(summary), *options.required_percent);
    throw std::runtime_error(text);
  }
}

}  // namespace

void addCommands(Command cartvo) {
  const Command command = addNamedCommand(cartvo, "watch");
  const auto options = std::make_shared<Options>();
  WatchSettings& watch = options->watch;
  command.addOption("--url", watch.url, "LCM URL, equal to lcm.url in the configuration of cartvod")
      .captureDefault();
  command
      .addOption("--seconds", watch.seconds,
                 "End this many seconds after the first message (default: at Ctrl-C)")
      .transform(positiveTimeInSeconds());
  command.addOption("--until-silent", watch.until_silent, "End after this many seconds without a stereo pair")
      .transform(positiveTimeInSeconds());
  command.addOption("--wait", watch.first_message, "Seconds to wait for the first message")
      .transform(positiveTimeInSeconds())
      .captureDefault();
  command
      .addOption("--output-dir", options->output,
                 "Folder for the valid body poses (trajectory.tum) and the summary (summary.json); created "
                 "if it is missing")
      .typeName("DIR");
  command.addFlag("--plain", watch.plain,
                  "Print one line per second instead of a full screen or a redrawn line");
  command.addFlag("--json", options->json,
                  "Print the summary as JSON; the live line goes to standard error then");
  command
      .addOption("--require-valid", options->required_percent,
                 "Fail (exit code 1) if less than this share of the pairs was valid, %")
      .range(0.0, 100.0)
      .typeName("PERCENT");
  command.callback([options] {
    options->watch.to_error_output = options->json;
    run(*options);
  });
}

}  // namespace cartvo
