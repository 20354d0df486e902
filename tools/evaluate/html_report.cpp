// The HTML report of an evaluation.
#include "tools/evaluate/html_report.hpp"

#include <algorithm>
#include <map>

#include "common/units.hpp"
#include "daemon/publish/odometry_reasons.hpp"
#include "tools/evaluate/comparison_table.hpp"
#include "tools/report/html.hpp"
#include "tools/report/table.hpp"

namespace cartvo {
namespace {

constexpr const char* kStyle =
    "main{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,520px),1fr));gap:1.5em 2em}"
    "figure{margin:0;min-width:0;break-inside:avoid}figcaption{font-size:.9em}svg{width:100%;height:auto}"
    "svg text{fill:var(--ink)}details{overflow-x:auto;font-size:.9em}summary{cursor:pointer}"
    "td,th{font-variant-numeric:tabular-nums}.wide{overflow-x:auto}.problem{font-weight:bold;color:var(--red)"
    "}"
    ".tiles{display:flex;flex-wrap:wrap;gap:1em;margin-bottom:1em}"
    ".tiles div{border:1px solid var(--line);padding:.5em 1em}.tiles b{display:block;font-size:1.6em}"
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

std::string paragraph(const std::string& text) {
  return "<p>" + escaped(text) + "</p>\n";
}

std::string motionNote(const ReportInput& input) {
  if (input.messages.empty())
    return paragraph(
        "Velocities, rates, validity and NEES are missing: they need the odometry.csv of 'cartvo replay' and "
        "a "
        "truth of the body, see cartvo-evaluate(1), --odometry.");
  return paragraph(input.odometry + ": " + validityText(input.messages)) +
         paragraph(consistencyVerdict(input.messages));
}

/// The figures that are looked at first, in large type.
std::string tiles(const ReportInput& input) {
  const Evaluation& evaluation = input.evaluation;
  Rows tiles{{evaluation.final_drift_fraction ? fixed(100.0 * *evaluation.final_drift_fraction, 2) + " %"
                                              : fixed(evaluation.final_drift, 3) + " m",
              "final drift" + std::string(evaluation.final_drift_fraction
                                              ? " of " + fixed(evaluation.path_length, 1) + " m"
                                              : "")},
             {fixed(1e3 * evaluation.relative_translation, 1) + " mm", "pose to pose (RPE)"},
             {fixed(evaluation.absolute_aligned, 3) + " m", "position, aligned (ATE)"}};
  if (!input.messages.empty()) {
    const ValidityFigures figures = validityFigures(judgedMessages(input.messages), input.limits);
    tiles.push_back({fixed(100.0 * figures.availability(), 1) + " %", "of the messages are VALID"});
    tiles.push_back({shareOfJudged(figures, figures.above_bound), "VALID messages above their bound"});
  }
  std::string html = "<div class=\"tiles\">";
  for (const std::vector<std::string>& tile : tiles)
    html += "<div><b>" + escaped(tile[0]) + "</b>" + escaped(tile[1]) + "</div>";
  return html + "</div>\n";
}

std::string measures(const std::vector<ReportInput>& inputs) {
  if (inputs.size() == 1)
    return tiles(inputs.front()) + measuresTable(inputs.front()) + motionNote(inputs.front());
  const ComparisonTable table = comparisonTable(inputs);
  return "<div class=\"wide\">" + tableElement(table.header, table.rows) + "</div>\n";
}

std::string figureElement(const Figure& figure) {
  return "<figure id=\"" + figure.name + "\">\n" +
         drawChart(figure.chart).svgElement(figure.chart.title, chartColourNames()) + "<figcaption>" +
         escaped(figure.caption) + "</figcaption>\n<details><summary>Numbers of this figure</summary>\n" +
         tableElement(figure.columns, figure.rows) + "</details></figure>\n";
}

}  // namespace

std::string evaluationPage(const ReportContext& context, const std::vector<ReportInput>& inputs,
                           const std::vector<Figure>& figures) {
  std::string names, problems, settings;
  for (const ReportInput& input : inputs) {
    names += (names.empty() ? "" : ", ") + input.estimate;
    for (const std::string& problem : input.evaluation.problems)
      problems += "<p class=\"problem\">" + escaped(input.estimate + ": " + problem) + "</p>\n";
  }
  for (const std::string& setting : context.settings)
    settings += (settings.empty() ? "" : ", ") + setting;
  std::string body = "<h1>cartvo evaluate</h1>\n" +
                     paragraph(names + " compared with " + context.truth + ", " + context.date +
                               ", cartvo " CARTVO_VERSION) +
                     (settings.empty() ? "" : paragraph("Settings: " + settings)) + problems +
                     measures(inputs) + "<main>\n";
  for (const Figure& figure : figures)
    body += figureElement(figure);
  return htmlPage("cartvo evaluate: " + names, chartColourStyle() + kStyle, body + "</main>\n");
}

void writeFigures(const std::filesystem::path& folder, const std::vector<Figure>& figures) {
  for (const Figure& figure : figures) {
    const Drawing drawing = drawChart(figure.chart);
    for (const char* extension : {".svg", ".png"})
      writeDrawing(folder / (figure.name + extension), drawing);
  }
}

}  // namespace cartvo
