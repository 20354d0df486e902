// `cartvo evaluate`: compares an estimated trajectory with the truth.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "common/atomic_file.hpp"
#include "tools/cartvo/commands.hpp"
#include "tools/cartvo/result_files.hpp"
#include "tools/evaluate/association.hpp"
#include "tools/evaluate/evaluation.hpp"
#include "tools/evaluate/plot.hpp"
#include "tools/evaluate/report.hpp"
#include "tools/trajectory/trajectory.hpp"

namespace cartvo {
namespace {

struct Options {
  std::filesystem::path estimate;
  std::filesystem::path truth;
  std::string json;
  std::filesystem::path plot;
};

void run(const Options& options, bool wants_json) {
  const bool json_alone = wants_json && (options.json.empty() || options.json == "-");
  checkResultFiles({json_alone ? "" : options.json, options.plot});
  const AssociatedTrajectories associated = associateFiles(options.estimate, options.truth);
  const Evaluation evaluation = evaluate(associated);
  if (wants_json) {
    nlohmann::ordered_json json{{"estimate", options.estimate.string()}, {"truth", options.truth.string()}};
    json.update(evaluationJson(evaluation));
    const std::string text = json.dump(2) + "\n";
    if (json_alone) {
      std::fputs(text.c_str(), stdout);
    } else {
      writeResultFile(options.json, text);
    }
  }
  if (!json_alone) std::fputs(evaluationTable(evaluation).c_str(), stdout);
  if (!options.plot.empty()) {
    const bool is_kitti = isKittiTrajectory(options.truth);
    writeDrawing(options.plot,
                 plotTrajectories(associated, is_kitti ? TopView::camera_axes : TopView::body_axes));
  }
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
  CLI::Option* json = command
                          ->add_option("--json", options->json,
                                       "Write the results as JSON to FILE; with '-' or no FILE to standard "
                                       "output instead of the table")
                          ->type_name("FILE")
                          ->expected(0, 1);
  addPlotOption(*command, options->plot, "both paths and the error");
  command->footer(
      "Files of TUM or EuRoC are compared by time: the truth is interpolated at the estimate's times. A "
      "KITTI file "
      "has no\n"
      "times: it is compared row by row, and both files must have the same number of rows.\n"
      "Examples:\n"
      "  cartvo evaluate out/poses.txt kitti_06/poses.txt --plot out/path.png\n"
      "  cartvo evaluate out/trajectory.tum truth.tum --json out/errors.json");
  command->callback([options, json] { run(*options, json->count() > 0); });
}

}  // namespace cartvo
