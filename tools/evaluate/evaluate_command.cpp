// `cartvo evaluate`: compares an estimated trajectory with the truth.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/atomic_file.hpp"
#include "common/command_line/parser.hpp"
#include "common/input_file.hpp"
#include "common/printable_text.hpp"
#include "common/units.hpp"
#include "tools/cartvo/alert_limits_option.hpp"
#include "tools/cartvo/commands.hpp"
#include "tools/cartvo/json_text.hpp"
#include "tools/cartvo/plot_option.hpp"
#include "tools/cartvo/result_files.hpp"
#include "tools/evaluate/alignment.hpp"
#include "tools/evaluate/association.hpp"
#include "tools/evaluate/compared_messages.hpp"
#include "tools/evaluate/comparison_table.hpp"
#include "tools/evaluate/evaluation.hpp"
#include "tools/evaluate/html_report.hpp"
#include "tools/evaluate/report.hpp"
#include "tools/report/html.hpp"
#include "tools/report/table.hpp"
#include "tools/trajectory/trajectory.hpp"

namespace cartvo {
namespace {

struct Options {
  std::vector<std::filesystem::path> files;  ///< estimates, without --truth also the truth
  std::filesystem::path truth;
  double offset = 0.0;  ///< s
  ComparisonSettings comparison;
  bool json = false;
  std::filesystem::path plot;
  std::filesystem::path odometry;
  std::filesystem::path report;
  std::filesystem::path figures;
  std::filesystem::path messages;
  pipeline::AlertLimits limits;
};

/// The estimate is a file of messages: the poses, velocities and bounds are theirs.
void readMessages(const Options& options, const std::filesystem::path& file, ReportInput& input) {
  std::vector<OdometryRow> rows = readOdometryFile(file);
  for (OdometryRow& row : rows)
    row.time_ns += options.comparison.offset_ns;
  const Trajectory truth = readBodyTruth(options.truth, file, rows);
  try {
    input.associated = associateByTime(bodyTrajectory(rows), truth);
    const std::filesystem::path poses = file.parent_path() / "trajectory.tum";
    if (frameOf(options.truth) == TrajectoryFrame::body && std::filesystem::exists(poses)) {
      std::string problem = frameProblem(file, frameOf(poses), options.truth, options.comparison.aligns);
      if (!problem.empty()) input.associated.problems.push_back(std::move(problem));
    }
    fitEstimate(options.comparison, input.associated);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(file.string() + " and " + options.truth.string() + ": " + error.what());
  }
  input.view = TopView::body_axes;
  input.messages = compareMotion(rows, truth);
  input.odometry = file.string();
}

/// The messages of --odometry, or of the odometry.csv beside the estimate if there is one. The latter is not
/// required: a problem with it is only a warning.
void addMessages(const Options& options, ReportInput& input) {
  if (!input.messages.empty()) return;
  const bool is_given = !options.odometry.empty();
  const std::filesystem::path odometry =
      is_given ? options.odometry : std::filesystem::path(input.estimate).parent_path() / "odometry.csv";
  if (!is_given && !std::filesystem::exists(odometry)) return;
  constexpr std::size_t kMaxWarningBytes = 4000;
  try {
    input.messages = compareMessages(odometry, options.truth, options.comparison.offset_ns);
    input.odometry = odometry.string();
  } catch (const std::runtime_error& error) {
    if (is_given) throw;
    std::fprintf(stderr, "cartvo: warning: velocities and NEES are left out: %s\n",
                 printableExcerpt(error.what(), kMaxWarningBytes).c_str());
  }
}

/// Rig and settings of the replay whose summary.json is beside the estimate, and the options of the
/// comparison.
std::vector<std::string> settingsOf(const Options& options, const ReportInput& input) {
  std::vector<std::string> settings;
  const std::filesystem::path summary = std::filesystem::path(input.estimate).parent_path() / "summary.json";
  constexpr std::uintmax_t kMaxBytes = 1U << 26U;
  nlohmann::json json;
  try {
    if (std::filesystem::exists(summary))
      json = nlohmann::json::parse(readInputText(summary, kMaxBytes), nullptr, false);
  } catch (const std::runtime_error&) {
    // The report goes without them.
  }
  const auto add = [&](const char* pointer, const std::string& name) {
    const nlohmann::json::json_pointer place(pointer);
    if (!json.is_object() || !json.contains(place)) return;
    const nlohmann::json& value = json[place];
    if (value.is_string() || value.is_number())
      settings.push_back(name + " " + (value.is_string() ? value.get<std::string>() : value.dump()));
  };
  add("/source", "source");
  add("/rig/name", "rig");
  add("/rig/origin", "of");
  add("/estimator", "estimator");
  add("/features", "features");
  add("/online_rig_refinement", "online rig refinement");
  if (options.comparison.offset_ns != 0) settings.push_back("--offset " + fixed(options.offset, 3) + " s");
  if (options.comparison.aligns) settings.emplace_back("--align");
  if (options.comparison.corrects_scale) settings.emplace_back("--correct-scale");
  return settings;
}

void writeReport(const Options& options, std::vector<ReportInput> inputs) {
  for (ReportInput& input : inputs)
    addMessages(options, input);
  const std::vector<Figure> figures = evaluationFigures(inputs);
  const ReportContext context{options.truth.string(), reportTime(), settingsOf(options, inputs.front())};
  if (!options.report.empty()) writeResultFile(options.report, evaluationPage(context, inputs, figures));
  if (options.figures.empty()) return;
  createFolders(options.figures);
  writeFigures(options.figures, figures);
}

nlohmann::ordered_json jsonOf(const Options& options, const ReportInput& input) {
  nlohmann::ordered_json json{{"estimate", input.estimate}, {"truth", options.truth.string()}};
  json.update(evaluationJson(input.evaluation));
  if (input.messages.empty()) return json;
  json["validity"] = validityJson(validityFigures(judgedMessages(input.messages), options.limits));
  const pipeline::AlertLimits& limits = options.limits;
  json["validity"]["alert_limits"] = {limits.velocity, kDegreesPerRadian * limits.angular_rate, limits.motion,
                                      kDegreesPerRadian * limits.rotation};
  return json;
}

void printResults(const Options& options, const std::vector<ReportInput>& inputs) {
  const ReportInput& first = inputs.front();
  if (options.json && inputs.size() == 1) return printJson(jsonOf(options, first));
  if (options.json) {
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const ReportInput& input : inputs)
      json.push_back(jsonOf(options, input));
    return printJson(json);
  }
  if (inputs.size() > 1) {
    std::fputs(comparisonTable(inputs).text.c_str(), stdout);
    return;
  }
  std::fputs(evaluationTable(first.evaluation).c_str(), stdout);
  if (first.messages.empty()) return;
  const ValidityFigures validity = validityFigures(judgedMessages(first.messages), options.limits);
  std::fputs(validityTable(validity, options.limits).c_str(), stdout);
}

ReportInput compare(const Options& options, const std::filesystem::path& file) {
  ReportInput input;
  input.estimate = file.string();
  input.limits = options.limits;
  if (isOdometryFile(file)) {
    readMessages(options, file, input);
  } else {
    if (!options.messages.empty())
      throw std::runtime_error(input.estimate + ": is no odometry.csv, whose messages --messages writes");
    input.associated = associateFiles(file, options.truth, options.comparison);
    input.view = isKittiTrajectory(options.truth) ? TopView::camera_axes : TopView::body_axes;
  }
  input.evaluation = evaluate(input.associated);
  return input;
}

void run(const Options& options) {
  checkResultFiles({options.plot, options.report, options.messages});
  std::vector<ReportInput> inputs;
  for (const std::filesystem::path& file : options.files)
    inputs.push_back(compare(options, file));
  printResults(options, inputs);
  if (!options.plot.empty()) writeDrawing(options.plot, evaluationPlot(inputs));
  if (!options.messages.empty())
    writeResultFile(options.messages, judgedMessagesCsv(judgedMessages(inputs.front().messages)));
  if (!options.report.empty() || !options.figures.empty()) writeReport(options, std::move(inputs));
}

void addFileOptions(Command command, Options& options) {
  command
      .addOption(
          "FILE", options.files,
          "ESTIMATE TRUTH, or with --truth one or more estimates. An estimate is the odometry.csv of a "
          "replay, or a trajectory: TUM or KITTI text, or EuRoC's data.csv")
      .required();
  command
      .addOption("--truth", options.truth,
                 "The true trajectory of the same frame (camera or body), in one of these formats")
      .typeName("FILE");
  command.addFlag("--json", options.json, "Print the results as JSON instead of the table");
  addAlertLimitsOption(command, options.limits);
  command
      .addOption("--messages", options.messages,
                 "File (.csv) for the errors and bounds of each message of an odometry.csv")
      .typeName("FILE");
  addPlotOption(command, options.plot, "the paths and their errors");
}

void addFitOptions(Command command, Options& options) {
  constexpr double kMaxOffset = 4e9;  // s
  command
      .addOption("--offset", options.offset,
                 "Seconds added to the estimate's instants, such as 18 for a truth in GPS time")
      .range(-kMaxOffset, kMaxOffset)
      .typeName("SECONDS");
  command.addFlag("--align", options.comparison.aligns,
                  "Fit the estimate's world (rotation and translation) and its axes to the truth");
  command.addFlag("--correct-scale", options.comparison.corrects_scale,
                  "Fit the scale of the estimate's path to the truth");
}

/// Takes the truth from the files unless --truth names it. Throws CommandLineError.
void separateTruth(Options& options) {
  constexpr double kNanoseconds = 1e9;
  options.comparison.offset_ns = std::llround(kNanoseconds * options.offset);
  const bool has_one = options.truth.empty() ? options.files.size() == 2 : options.files.size() == 1;
  if (options.truth.empty()) {
    if (!has_one)
      throw CommandLineError("--truth",
                             "expected ESTIMATE TRUTH, or --truth TRUTH and one or more estimates; found " +
                                 std::to_string(options.files.size()) + " files");
    options.truth = options.files.back();
    options.files.pop_back();
  }
  if (!has_one && !options.messages.empty()) throw CommandLineError("--messages", "is for a single estimate");
  if (!has_one && !options.odometry.empty()) throw CommandLineError("--odometry", "is for a single estimate");
}

}  // namespace

void addCommands(Command cartvo) {
  const Command command = addNamedCommand(cartvo, "evaluate");
  const auto options = std::make_shared<Options>();
  addFileOptions(command, *options);
  addFitOptions(command, *options);
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
      "  cartvo evaluate out/trajectory.tum truth.tum --report out/report.html\n"
      "  cartvo evaluate one.tum other.tum --truth truth.tum --align --plot paths.svg");
  command.callback([options, report, figures] {
    if (!options->odometry.empty() && report.count() + figures.count() == 0)
      throw CommandLineError("--odometry", "is used by --report and --figures-dir only; name one of them");
    separateTruth(*options);
    run(*options);
  });
}

}  // namespace cartvo
