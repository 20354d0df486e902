// `cartvo calibrate plan`: predicts depth error and overlap for given baselines, lenses and resolutions.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "calib/format/rig_file.hpp"
#include "calib/rectification/rectification.hpp"
#include "common/atomic_file.hpp"
#include "common/command_line/parser.hpp"
#include "tools/calibrate/plan/plan_report.hpp"
#include "tools/calibrate/plan/stereo_design.hpp"
#include "tools/calibrate/subcommands.hpp"
#include "tools/cartvo/json_text.hpp"
#include "tools/cartvo/result_files.hpp"
#include "vo_core/odometry_settings.hpp"

namespace cartvo {
namespace {

using calibrate::StereoDesign;

struct Options {
  std::vector<std::filesystem::path> rigs;
  std::vector<double> baselines{0.115};
  std::vector<double> widths{680.0};
  std::vector<double> views_deg, focal_lengths_mm, focal_lengths_px;
  double sensor_width_mm = 0.0;
  double relative_error_percent = 5.0;
  calibrate::PlanSettings questions{
      vo::OdometrySettings{}.motion.disparity_noise, std::nullopt, 0.0, {5.0, 10.0, 20.0, 40.0}};
  std::string format = "text";
  bool json = false;
  std::filesystem::path output, plot;
};

StereoDesign designOf(const std::filesystem::path& rig_file) {
  const calib::Rig rig = calib::readRig(rig_file);
  const calib::Rectification rectified = calib::computeRectification(rig, rig.rectification);
  return {rectified.baseline, rectified.focal_length, static_cast<double>(rectified.size.width)};
}

/// All given focal lengths for an image of this width, px.
std::vector<double> focalLengths(const Options& options, double width) {
  std::vector<double> all = options.focal_lengths_px;
  for (const double view : options.views_deg)
    all.push_back(calibrate::focalLengthOfView(view * std::numbers::pi / 180.0, width));
  for (const double focal_length : options.focal_lengths_mm)
    all.push_back(calibrate::focalLengthOfLens(focal_length, options.sensor_width_mm, width));
  return all;
}

std::vector<StereoDesign> designsOf(const Options& options) {
  std::vector<StereoDesign> designs;
  for (const std::filesystem::path& rig : options.rigs)
    designs.push_back(designOf(rig));
  for (const double baseline : options.baselines) {
    for (const double width : options.widths) {
      for (const double focal_length : focalLengths(options, width))
        designs.push_back({baseline, focal_length, width});
    }
  }
  if (designs.empty()) {
    throw CommandLineError("one of --hfov, --focal-mm with --sensor-width, --focal-px and --rig is required");
  }
  return designs;
}

std::string reportOf(const Options& options, const std::vector<StereoDesign>& designs) {
  if (options.json) return jsonText(calibrate::planJson(designs, options.questions));
  return calibrate::planTable(designs, options.questions,
                              options.format == "markdown" ? ReportFormat::markdown : ReportFormat::text);
}

void run(Options& options) {
  options.questions.relative_error = options.relative_error_percent / 100.0;
  checkResultFiles({options.output, options.plot});
  const std::vector<StereoDesign> designs = designsOf(options);
  const std::string report = reportOf(options, designs);
  if (!options.plot.empty()) writeDrawing(options.plot, calibrate::planPlot(designs, options.questions));
  if (options.output.empty()) {
    std::fputs(report.c_str(), stdout);
  } else {
    writeResultFile(options.output, report);
  }
}

void addDesignOptions(Command command, Options& options) {
  command.addOption("--baseline", options.baselines, "Distances of the cameras, m")
      .delimiter(',')
      .range(0.005, 10.0)
      .captureDefault();
  command.addOption("--width", options.widths, "Widths of the images, px")
      .delimiter(',')
      .range(16.0, 8192.0)
      .captureDefault();
  command.addOption("--hfov", options.views_deg, "Horizontal angles of view, deg")
      .delimiter(',')
      .range(1.0, 160.0);
  command.addOption("--focal-px", options.focal_lengths_px, "Focal lengths, px")
      .delimiter(',')
      .range(1.0, 1e5);
  const Option sensor = command
                            .addOption("--sensor-width", options.sensor_width_mm,
                                       "Width of the sensor area that the image covers, mm")
                            .range(0.1, 100.0);
  command.addOption("--focal-mm", options.focal_lengths_mm, "Focal lengths of lenses, mm")
      .delimiter(',')
      .range(0.1, 1000.0)
      .needs(sensor);
  command.addOption("--rig", options.rigs, "Rig files to compare with, as rectified").typeName("FILE");
}

void addQuestionOptions(Command command, Options& options) {
  command
      .addOption("--disparity-noise", options.questions.disparity_noise,
                 "Standard deviation of a disparity, px (default: cartvod's)")
      .range(0.001, 10.0)
      .captureDefault();
  command
      .addOption("--largest-disparity", options.questions.largest_disparity,
                 "Largest disparity that is matched, px (default: cartvod's, half of the image's width)")
      .range(1.0, 8192.0);
  command.addOption("--ranges", options.questions.ranges, "Ranges at which to report error and overlap, m")
      .delimiter(',')
      .range(0.1, 1000.0)
      .captureDefault();
  command.addOption("--good", options.relative_error_percent, "Largest error of a good depth, % of the depth")
      .range(0.01, 100.0)
      .captureDefault();
}

void addReportOptions(Command command, Options& options) {
  const Option format = command.addOption("--format", options.format, "text or markdown")
                            .choices({"text", "markdown"})
                            .typeName("NAME")
                            .captureDefault();
  command.addFlag("--json", options.json, "Report as JSON, with all numbers").excludes(format);
  command.addOption("--output", options.output, "Write the report into this file").typeName("FILE");
  const auto check_name = [](const std::string& name) -> std::string {
    try {
      checkDrawingName(name);
    } catch (const std::exception& error) {
      return error.what();
    }
    return {};
  };
  command
      .addOption("--plot", options.plot, "Draw error and overlap over the range into this .svg or .png file")
      .check(check_name)
      .typeName("FILE");
}

}  // namespace

void addCalibratePlan(Command calibrate) {
  const Command command = calibrate.addSubcommand(
      "plan", "Compare depth error and overlap for baselines, lenses and resolutions");
  const auto options = std::make_shared<Options>();
  addDesignOptions(command, *options);
  addQuestionOptions(command, *options);
  addReportOptions(command, *options);
  command.footer(
      "The table has a column for each combination of the lists. Examples:\n"
      "  cartvo calibrate plan --baseline 0.115,0.3,0.5 --hfov 70.6\n"
      "  cartvo calibrate plan --focal-mm 2.8,4,6 --sensor-width 5.4 --width 680,1280 --plot plan.svg");
  command.callback([options] { run(*options); });
}

}  // namespace cartvo
