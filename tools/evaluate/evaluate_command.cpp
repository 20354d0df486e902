// `cartvo evaluate`: compares an estimated trajectory with the truth.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>

#include "common/atomic_file.hpp"
#include "common/printable_text.hpp"
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
};

TopView viewOf(const Options& options) {
  return isKittiTrajectory(options.truth) ? TopView::camera_axes : TopView::body_axes;
}

/// The messages of --odometry, or of the odometry.csv beside the estimate if there is one. The latter is not
/// required: a problem with it is only a warning.
void addMessages(const Options& options, ReportFiles& files, ReportInput& input) {
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

void writeReport(const Options& options, const AssociatedTrajectories& associated,
                 const Evaluation& evaluation) {
  ReportFiles files{options.estimate.string(), options.truth.string(), {}};
  ReportInput input{associated, evaluation, viewOf(options), {}};
  addMessages(options, files, input);
  const std::vector<Figure> figures = evaluationFigures(input);
  if (!options.report.empty()) writeResultFile(options.report, evaluationPage(files, input, figures));
  if (options.figures.empty()) return;
  createFolders(options.figures);
  writeFigures(options.figures, figures);
}

void run(const Options& options) {
  checkResultFiles({options.plot, options.report});
  const AssociatedTrajectories associated = associateFiles(options.estimate, options.truth);
  const Evaluation evaluation = evaluate(associated);
  if (options.json) {
    nlohmann::ordered_json json{{"estimate", options.estimate.string()}, {"truth", options.truth.string()}};
    json.update(evaluationJson(evaluation));
    printJson(json);
  } else {
    std::fputs(evaluationTable(evaluation).c_str(), stdout);
  }
  if (!options.plot.empty()) writeDrawing(options.plot, plotTrajectories(associated, viewOf(options)));
  if (!options.report.empty() || !options.figures.empty()) writeReport(options, associated, evaluation);
}

}  // namespace

void addEvaluateCommand(CLI::App& cartvo) {
  CLI::App* command = cartvo.add_subcommand("evaluate", "Compare a trajectory with the truth");
  const auto options = std::make_shared<Options>();
  command->add_option("ESTIMATE", options->estimate, "The trajectory: TUM or KITTI text, or EuRoC's data.csv")
      ->required();
  command
      ->add_option("TRUTH", options->truth,
                   "The true trajectory of the same frame (camera or body), in one of these formats")
      ->required();
  command->add_flag("--json", options->json, "Print the results as JSON instead of the table");
  addPlotOption(*command, options->plot, "both paths and the error");
  CLI::Option* report =
      command
          ->add_option("--report", options->report,
                       "File for a report (one HTML page): paths, errors over distance and time, segments, "
                       "velocities, rates and NEES")
          ->type_name("FILE");
  CLI::Option* figures =
      command
          ->add_option("--figures-dir", options->figures,
                       "Folder for the report's figures as .svg and .png; created if it is missing")
          ->type_name("DIR");
  command
      ->add_option("--odometry", options->odometry,
                   "With --report or --figures-dir: the odometry.csv of the replay, for velocities, rates, "
                   "validity and NEES (default: that beside ESTIMATE)")
      ->type_name("FILE");
  command->footer(
      "Files of TUM or EuRoC are compared by time: the truth is interpolated at the estimate's times. A "
      "KITTI file "
      "has no\n"
      "times: it is compared row by row, and both files must have the same number of rows.\n"
      "Examples:\n"
      "  cartvo evaluate out/poses.txt kitti_06/poses.txt --plot out/path.png\n"
      "  cartvo evaluate out/trajectory.tum truth.tum --json\n"
      "  cartvo evaluate out/trajectory.tum truth.tum --report out/report.html");
  command->callback([options, report, figures] {
    if (!options->odometry.empty() && report->count() + figures->count() == 0)
      throw CLI::ValidationError("--odometry",
                                 "is used by --report and --figures-dir only; name one of them");
    run(*options);
  });
}

}  // namespace cartvo
