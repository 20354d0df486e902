// Command line of `cartvo watch`.
#include <cstdio>
#include <memory>

#include "tools/cartvo/commands.hpp"
#include "tools/cartvo/result_files.hpp"
#include "tools/watch/watch.hpp"

namespace cartvo {
namespace {

struct Options {
  WatchSettings watch;
  std::filesystem::path trajectory;
  std::filesystem::path summary;
};

void run(const Options& options) {
  checkResultFiles({options.trajectory, options.summary});
  const OdometryStatistics statistics = watchOdometry(options.watch);
  const OdometrySummary summary = statistics.summarise();
  std::printf("%s", summaryText(summary).c_str());
  if (!options.trajectory.empty())
    writeTum(options.trajectory, statistics.trajectory(), TrajectoryFrame::body);
  if (!options.summary.empty()) writeSummary(options.summary, summary);
}

}  // namespace

void addWatchCommand(CLI::App& cartvo) {
  CLI::App* command =
      cartvo.add_subcommand("watch", "Show the odometry of cartvod live, with a summary at the end");
  const auto options = std::make_shared<Options>();
  WatchSettings& watch = options->watch;
  command->add_option("--url", watch.url, "LCM URL, equal to lcm.url in the configuration of cartvod")
      ->capture_default_str();
  command
      ->add_option("--seconds", watch.seconds,
                   "End this many seconds after the first message (default: at Ctrl-C)")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--until-silent", watch.until_silent, "End after this many seconds without a stereo pair")
      ->check(CLI::PositiveNumber);
  command->add_option("--wait", watch.first_message, "Seconds to wait for the first message")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--trajectory", options->trajectory, "File for the valid body poses (TUM format)");
  command->add_option("--summary", options->summary, "File for the summary (JSON)");
  command->add_flag("--plain", watch.plain, "Print one line per second instead of redrawing one");
  command->callback([options] { run(*options); });
}

}  // namespace cartvo
