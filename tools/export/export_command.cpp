// `cartvo export`: writes recordings and results in formats of other tools.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>

#include "common/command_line/parser.hpp"
#include "common/printable_text.hpp"
#include "tools/cartvo/commands.hpp"
#include "tools/cartvo/interruption.hpp"
#include "tools/cartvo/json_text.hpp"
#include "tools/cartvo/progress_bar.hpp"
#include "tools/cartvo/result_files.hpp"
#include "tools/export/export_format.hpp"
#include "tools/replay/summary.hpp"
#include "tools/report/counted.hpp"

namespace cartvo {
namespace {

struct Options {
  std::filesystem::path source, rig, output;
  std::string format;
  int threads = 2;
  bool json = false;
};

ExportSource readWithProgress(const Options& options, const Interruption& interruption) {
  ProgressBar progress("pairs");
  return readExportSource(options.source, options.rig,
                          [&](const pipeline::PairResult& result, std::size_t expected) {
                            interruption.check();
                            progress.show(result.sequence + 1, expected);
                          });
}

void writeWithProgress(const ExportSource& source, ExportFormat format, const std::filesystem::path& file,
                       const Interruption& interruption) {
  std::optional<ProgressBar> progress;
  writeExport(source, format, file, [&](std::size_t pictures) {
    interruption.check();
    if (!progress) progress.emplace("pictures");
    progress->show(pictures, 0);
  });
}

void printWarnings(const Replay& replay) {
  constexpr std::size_t kMaxWarningBytes = 4000;
  for (const std::string& problem : replay.problems)
    std::fprintf(stderr, "cartvo: warning: %s\n", printableExcerpt(problem, kMaxWarningBytes).c_str());
  if (const std::string reason = nothingValidText(replay); !reason.empty())
    std::fprintf(stderr, "cartvo: warning: %s\n", reason.c_str());
}

void run(const Options& options) {
  const ExportFormat format = exportFormatNamed(options.format);
  for (const std::filesystem::path& file : exportedFiles(format, options.output))
    checkResultFiles({file});
  cv::setNumThreads(options.threads);
  const Interruption interruption;
  const ExportSource source = readWithProgress(options, interruption);
  if (source.replay) printWarnings(*source.replay);
  writeWithProgress(source, format, options.output, interruption);
  const std::size_t count = source.replay ? source.replay->pairs.size() : source.poses.size();
  if (options.json) {
    const nlohmann::ordered_json json{{"output", options.output.string()},
                                      {"format", options.format},
                                      {source.replay ? "pairs" : "poses", count}};
    printJson(json);
    return;
  }
  std::printf("%s written to %s\n", counted(count, source.replay ? "pair" : "pose").c_str(),
              options.output.c_str());
}

}  // namespace

void addCommands(Command cartvo) {
  const Command command = addNamedCommand(cartvo, "export");
  const auto options = std::make_shared<Options>();
  command
      .addOption(
          "SOURCE", options->source,
          "A recording (cartvod --record), a folder of images as for cartvo replay, an output folder of "
          "cartvo replay, or a trajectory in TUM's or EuRoC's format")
      .required();
  command.addOption("--format", options->format, "What to write")
      .required()
      .choices(exportFormatNames())
      .typeName("FORMAT");
  command.addOption("--output", options->output, "The file to write; the folder, for rosbag2-mcap")
      .required()
      .typeName("FILE");
  command.addOption("--rig", options->rig, "Rig file, in place of that of the source; as for cartvo replay")
      .typeName("FILE");
  command
      .addOption("--threads", options->threads,
                 "Threads for image operations; the results do not depend on it")
      .range(1, 64)
      .captureDefault();
  command.addFlag("--json", options->json, "Print what was written as JSON");
  command.footer(
      "  mcap     for Foxglove, Rerun and PlotJuggler: odometry, poses, frames, log, and the pictures of a\n"
      "           recording as the cameras sent them\n"
      "  rosbag2-mcap  bag of ROS 2, for ros2 bag play: nav_msgs/msg/Odometry, tf2_msgs/msg/TFMessage, and\n"
      "           the pictures of a recording as foxglove_msgs/msg/CompressedVideo\n"
      "  lcm-log  event log of LCM with CARTVO_ODOMETRY, for lcm-logplayer\n"
      "  tum      poses of the body: seconds x y z qx qy qz qw\n"
      "  kitti    poses of the left camera (of the trajectory, if SOURCE is one): 3x4 matrices\n"
      "  euroc    poses of the body: ns,x,y,z,qw,qx,qy,qz\n"
      "  csv      the messages with covariances, as odometry.csv of cartvo replay\n"
      "A recording or image folder is replayed first, as by cartvo replay. A trajectory has poses only: it\n"
      "can become mcap, tum, kitti and euroc. See cartvo-export(1).\n"
      "Examples:\n"
      "  cartvo export drive --format mcap --output drive.mcap\n"
      "  cartvo export drive --format rosbag2-mcap --output drive_bag\n"
      "  cartvo export drive --format lcm-log --output drive.lcmlog\n"
      "  cartvo export out --format euroc --output drive.csv");
  command.callback([options] { run(*options); });
}

}  // namespace cartvo
