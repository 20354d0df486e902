// `cartvo evaluate`: compares an estimated trajectory with the truth.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/atomic_file.hpp"
#include "common/command_line/parser.hpp"
#include "common/printable_text.hpp"
#include "common/units.hpp"
#include "tools/cartvo/alert_limits_option.hpp"
#include "tools/cartvo/commands.hpp"
#include "tools/cartvo/json_text.hpp"
#include "tools/cartvo/result_files.hpp"
#include "tools/evaluate/association.hpp"
#include "tools/evaluate/compared_messages.hpp"
#include "tools/evaluate/evaluation.hpp"
#include "tools/evaluate/html_report.hpp"
#include "tools/evaluate/plot.hpp"
#include "tools/evaluate/report.hpp"
#include "tools/trajectory/trajectory.hpp"

namespace cartvo {
namespace {

struct Options {
  std::filesystem::path estimate;
  std::filesystem::path truth;
  bool json = false;
  std::filesystem::path plot;
  std::filesystem::path odometry;
  std::filesystem::path report;
  std::filesystem::path figures;
  std::filesystem::path messages;
  pipeline::AlertLimits limits;
};

/// The estimate is a file of messages: the poses, velocities and bounds are theirs.
void readMessages(const Options& options, ReportFiles& files, ReportInput& input) {
  const std::vector<OdometryRow> rows = readOdometryFile(options.estimate);
  const Trajectory truth = readBodyTruth(options.truth, options.estimate, rows);
  try {
    input.associated = associateByTime(bodyTrajectory(rows), truth);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(files.estimate + " and " + files.truth + ": " + error.what());
  }
  input.view = TopView::body_axes;
  input.messages = compareMotion(rows, truth);
  files.odometry = files.estimate;
}

/// The messages of --odometry, or of the odometry.csv beside the estimate if there is one. The latter is not
/// required: a problem with it is only a warning.
void addMessages(const Options& options, ReportFiles& files, ReportInput& input) {
  if (!input.messages.empty()) return;
  const bool is_given = !options.odometry.empty();
  const std::filesystem::path odometry =
      is_given ? options.odometry : options.estimate.parent_path() / "odometry.csv";
  if (!is_given && !std::filesystem::exists(odometry)) return;
  constexpr std::size_t kMaxWarningBytes = 4000;
  try {
    input.messages = compareMessages(odometry, options.truth);
    files.odometry = odometry.string();
  } catch (const std::runtime_error& error) {
    if (is_given) throw;
    std::fprintf(stderr, "cartvo: warning: velocities and NEES are left out: %s\n",
                 printableExcerpt(error.what(), kMaxWarningBytes).c_str());
  }
}

void writeReport(const Options& options, ReportFiles files, ReportInput input) {
  addMessages(options, files, input);
  const std::vector<Figure> figures = evaluationFigures(input);
  if (!options.report.empty()) writeResultFile(options.report, evaluationPage(files, input, figures));
  if (options.figures.empty()) return;
  createFolders(options.figures);
  writeFigures(options.figures, figures);
}

void printResults(const Options& options, const ReportInput& input) {
  const bool has_messages = !input.messages.empty();
  const ValidityFigures validity = validityFigures(judgedMessages(input.messages), options.limits);
  if (options.json) {
    nlohmann::ordered_json json{{"estimate", options.estimate.string()}, {"truth", options.truth.string()}};
    json.update(evaluationJson(input.evaluation));
    if (has_messages) {
      json["validity"] = validityJson(validity);
      const pipeline::AlertLimits& limits = options.limits;
      json["validity"]["alert_limits"] = {limits.velocity, kDegreesPerRadian * limits.angular_rate,
                                          limits.motion, kDegreesPerRadian * limits.rotation};
    }
    printJson(json);
  } else {
    std::fputs(evaluationTable(input.evaluation).c_str(), stdout);
    if (has_messages) std::fputs(validityTable(validity, options.limits).c_str(), stdout);
  }
}

void run(const Options& options) {
  checkResultFiles({options.plot, options.report, options.messages});
  ReportFiles files{options.estimate.string(), options.truth.string(), {}};
  ReportInput input;
  input.limits = options.limits;
  if (isOdometryFile(options.estimate)) {
    readMessages(options, files, input);
  } else {
    if (!options.messages.empty())
      throw std::runtime_error(files.estimate + ": is no odometry.csv, whose messages --messages writes");
    input.associated = associateFiles(options.estimate, options.truth);
    input.view = isKittiTrajectory(options.truth) ? TopView::camera_axes : TopView::body_axes;
  }
  input.evaluation = evaluate(input.associated);
  printResults(options, input);
  if (!options.plot.empty()) writeDrawing(options.plot, plotTrajectories(input.associated, input.view));
  if (!options.messages.empty())
    writeResultFile(options.messages, judgedMessagesCsv(judgedMessages(input.messages)));
  if (!options.report.empty() || !options.figures.empty()) writeReport(options, files, input);
}

void addFileOptions(Command command, Options& options) {
  command
      .addOption("ESTIMATE", options.estimate,
                 "The odometry.csv of a replay, or a trajectory: TUM or KITTI text, or EuRoC's data.csv")
      .required();
  command
      .addOption("TRUTH", options.truth,
                 "The true trajectory of the same frame (camera or body), in one of these formats")
      .required();
  command.addFlag("--json", options.json, "Print the results as JSON instead of the table");
  addAlertLimitsOption(command, options.limits);
  command
      .addOption("--messages", options.messages,
                 "File (.csv) for the errors and bounds of each message of an odometry.csv")
      .typeName("FILE");
  addPlotOption(command, options.plot, "both paths and the error");
}

}  // namespace

void addEvaluateCommand(Command cartvo) {
  const Command command = cartvo.addSubcommand("evaluate", "Compare a trajectory with the truth");
  const auto options = std::make_shared<Options>();
  addFileOptions(command, *options);
  const Option report =
      command
          .addOption("--report", options->report,
                     "File for a report (one HTML page): paths, errors over distance and time, segments, "
                     "velocities, rates, NEES and errors against bounds")
          .typeName("FILE");
  const Option figures =
      command
          .addOption("--figures-dir", options->figures,
                     "Folder for the report's figures as .svg and .png; created if it is missing")
          .typeName("DIR");
  command
      .addOption("--odometry", options->odometry,
                 "With --report or --figures-dir: the odometry.csv of the replay, for velocities, rates, "
                 "validity and NEES (default: that beside ESTIMATE)")
      .typeName("FILE");
  command.footer(
      "Files of TUM or EuRoC are compared by time: the truth is interpolated at the estimate's times. A "
      "KITTI file "
      "has no\n"
      "times: it is compared row by row, and both files must have the same number of rows. Of an "
      "odometry.csv "
      "the velocities,\n"
      "rates and bounds are compared too: how many VALID messages are above an alert limit or their bound.\n"
      "Examples:\n"
      "  cartvo evaluate out/poses.txt kitti_06/poses.txt --plot out/path.png\n"
      "  cartvo evaluate out/odometry.csv truth.tum --json\n"
      "  cartvo evaluate out/trajectory.tum truth.tum --report out/report.html");
  command.callback([options, report, figures] {
    if (!options->odometry.empty() && report.count() + figures.count() == 0)
      throw CommandLineError("--odometry", "is used by --report and --figures-dir only; name one of them");
    run(*options);
  });
}

}  // namespace cartvo
