// The HTML report of an evaluation.
#include "tools/evaluate/html_report.hpp"

#include <algorithm>
#include <map>

#include "common/units.hpp"
#include "daemon/publish/odometry_reasons.hpp"
#include "tools/report/html.hpp"
#include "tools/report/table.hpp"

namespace cartvo {
namespace {

constexpr const char* kStyle =
    "main{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,520px),1fr));gap:1.5em 2em}"
    "figure{margin:0;min-width:0;break-inside:avoid}figcaption{font-size:.9em}svg{width:100%;height:auto}"
    "svg text{fill:var(--ink)}details{overflow-x:auto;font-size:.9em}summary{cursor:pointer}"
    "td,th{font-variant-numeric:tabular-nums}"
    "@media "
    "print{main{display:block}figure{max-width:16cm;margin-bottom:1em}details:not([open]){display:none}}";

using Rows = std::vector<std::vector<std::string>>;

void addSegmentRows(Rows& rows, const std::string& name, const SegmentErrors& errors) {
  if (errors.count == 0) {
    rows.push_back({name, kNoValue, "the path is too short"});
    return;
  }
  rows.push_back({name,
                  fixed(100.0 * errors.translation, 3) + " %, " +
                      fixed(kDegreesPerRadian * errors.rotation, 5) + " deg/m",
                  std::to_string(errors.count) + " segments"});
}

void addValidityRows(Rows& rows, const ReportInput& input) {
  if (input.messages.empty()) return;
  const ValidityFigures figures = validityFigures(judgedMessages(input.messages), input.limits);
  rows.push_back({"available", fixed(100.0 * figures.availability(), 2) + " % of the messages are VALID",
                  "longest gap " + fixed(figures.longest_gap, 2) + " s"});
  rows.push_back({"VALID messages above an alert limit", shareOfJudged(figures, figures.above_limit),
                  "largest errors " + fixed(figures.velocity_error, 3) + " m/s, " +
                      fixed(kDegreesPerRadian * figures.rate_error, 2) + " deg/s"});
  rows.push_back({"VALID messages above their bound", shareOfJudged(figures, figures.above_bound),
                  "any component of velocity, rates or the motion of the last second"});
}

std::string measuresTable(const ReportInput& input) {
  const Evaluation& evaluation = input.evaluation;
  Rows rows{
      {"poses compared", std::to_string(evaluation.poses),
       std::string(evaluation.method == AssociationMethod::time ? "by time" : "row by row") +
           (evaluation.unmatched == 0 ? ""
                                      : ", " + std::to_string(evaluation.unmatched) + " without a truth")},
      {"path length", fixed(evaluation.path_length, 3) + " m",
       "estimated " + fixed(evaluation.estimated_path_length, 3) + " m"},
      {"final drift",
       fixed(evaluation.final_drift, 3) + " m, " + fixed(kDegreesPerRadian * evaluation.final_rotation, 3) +
           " deg",
       evaluation.final_drift_fraction ? fixed(100.0 * *evaluation.final_drift_fraction, 3) + " % of the path"
                                       : "the path is too short for a percentage"},
      {"position, aligned (ATE)", fixed(evaluation.absolute_aligned, 4) + " m",
       "RMSE after the best rigid alignment"},
      {"position, same start", fixed(evaluation.absolute_origin, 4) + " m", "RMSE"},
      {"pose to pose (RPE)",
       fixed(evaluation.relative_translation, 4) + " m, " +
           fixed(kDegreesPerRadian * evaluation.relative_rotation, 4) + " deg",
       "RMSE"}};
  addSegmentRows(rows, "segments of 5 to 40 m", evaluation.short_segments.all);
  addSegmentRows(rows, "segments of 100 to 800 m (KITTI)", evaluation.long_segments.all);
  addValidityRows(rows, input);
  return tableElement({"measure", "value", "remark"}, rows);
}

/// Numbers of messages that are not valid, by reason.
std::string validityText(const std::vector<ComparedMessage>& messages) {
  std::map<std::string, std::size_t> reasons;
  std::size_t invalid = 0;
  for (const ComparedMessage& message : messages) {
    if (message.valid) continue;
    ++invalid;
    ++reasons[daemon::reasonNames(message.reasons)];
  }
  std::string text = std::to_string(messages.size()) + " messages, " + std::to_string(invalid) + " not valid";
  for (const auto& [reason, count] : reasons)
    text += (reason == reasons.begin()->first ? ": " : "; ") + std::to_string(count) + " " + reason;
  return text;
}

std::string motionNote(const ReportFiles& files, const ReportInput& input) {
  if (!input.messages.empty())
    return "<p>" + escaped(files.odometry + ": " + validityText(input.messages)) + "</p>\n";
  return "<p>Velocities, rates, validity and NEES are missing: they need the odometry.csv of 'cartvo replay' "
         "and a "
         "truth of the body, see cartvo-evaluate(1), --odometry.</p>\n";
}

std::string figureElement(const Figure& figure) {
  return "<figure id=\"" + figure.name + "\">\n" +
         drawChart(figure.chart).svgElement(figure.chart.title, chartColourNames()) + "<figcaption>" +
         escaped(figure.caption) + "</figcaption>\n<details><summary>Numbers of this figure</summary>\n" +
         tableElement(figure.columns, figure.rows) + "</details></figure>\n";
}

}  // namespace

std::string evaluationPage(const ReportFiles& files, const ReportInput& input,
                           const std::vector<Figure>& figures) {
  std::string body = "<h1>cartvo evaluate</h1>\n<p>" + escaped(files.estimate) + " compared with " +
                     escaped(files.truth) + ", cartvo " CARTVO_VERSION "</p>\n" + measuresTable(input) +
                     motionNote(files, input) + "<main>\n";
  for (const Figure& figure : figures)
    body += figureElement(figure);
  return htmlPage("cartvo evaluate: " + files.estimate, chartColourStyle() + kStyle, body + "</main>\n");
}

void writeFigures(const std::filesystem::path& folder, const std::vector<Figure>& figures) {
  for (const Figure& figure : figures) {
    const Drawing drawing = drawChart(figure.chart);
    for (const char* extension : {".svg", ".png"})
      writeDrawing(folder / (figure.name + extension), drawing);
  }
}

}  // namespace cartvo
