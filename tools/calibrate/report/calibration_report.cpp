// HTML report of a calibration.
#include "tools/calibrate/report/calibration_report.hpp"

#include <fmt/format.h>

#include "tools/calibrate/report/calibration_plots.hpp"
#include "tools/calibrate/report/calibration_summary.hpp"
#include "tools/report/html.hpp"

namespace cartvo {
namespace {

constexpr const char* kStyle =
    "body{font-family:sans-serif;max-width:1100px;margin:2em auto;padding:0 1em;color:#222}"
    "table{border-collapse:collapse;margin:.5em 0}th,td{border:1px solid #ccc;padding:.2em "
    ".6em;text-align:left}"
    "img{max-width:100%}.passed{color:#183}.reserved{color:#a60}.failed{color:#c22}figure{display:inline-"
    "block;margin:.5em 1em "
    ".5em 0}";

std::string section(const std::string& title, const std::string& content) {
  return "<h2>" + escaped(title) + "</h2>\n" + content;
}

std::string figure(const std::string& plot, const std::string& caption) {
  return "<figure>" + plot + "<figcaption>" + escaped(caption) + "</figcaption></figure>\n";
}

std::string verdict(const calib::Calibration& calibration) {
  std::vector<std::vector<std::string>> rows;
  for (const calib::ValidationCheck& check : calibration.checks) {
    rows.push_back({check.passed ? "passed" : "FAILED", check.name, checkValueText(check),
                    fmt::format("{:.3g} {}", check.limit, check.unit)});
  }
  const bool has_reservations = !calib::reservationsOf(calibration).empty();
  const char* const style = !calibration.passed() ? "failed" : has_reservations ? "reserved" : "passed";
  std::string text = escaped(verdictText(calibration));
  for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n'))
    text.replace(at, 1, "<br>");
  const std::string next =
      calib::nextViewAdvice(calibration.left_coverage, calibration.right_coverage, calibration.tilts);
  return fmt::format("<p class=\"{}\"><strong>{}</strong></p>\n{}", style, text,
                     next.empty() ? "" : "<p>To improve it, " + escaped(next) + ".</p>\n") +
         tableElement({"", "check", "value", "limit"}, rows);
}

std::string models(const calib::Calibration& calibration) {
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < calibration.candidates.size(); ++i) {
    const calib::CandidateModel& candidate = calibration.candidates[i];
    const auto number = [&](double calib::CrossValidation::*value) {
      return candidate.validation ? fmt::format("{:.3f}", *candidate.validation.*value) : std::string("-");
    };
    rows.push_back({calib::modelName(candidate.model), number(&calib::CrossValidation::rms),
                    number(&calib::CrossValidation::vertical_disparity_rms),
                    number(&calib::CrossValidation::vertical_disparity_p95),
                    i == calibration.chosen ? "chosen" : candidate.refusal});
  }
  return tableElement({"model", "held-out RMS, px", "rows RMS, px", "rows 95 %, px", ""}, rows);
}

std::string uncertainties(const calib::Calibration& calibration) {
  std::vector<std::vector<std::string>> rows;
  for (const calib::ParameterEstimate& parameter : calibration.result().parameters) {
    rows.push_back({parameter.name.name, fmt::format("{:.6g}", parameter.value),
                    fmt::format("{:.2g}", parameter.stddev), parameter.name.unit});
  }
  return tableElement({"parameter", "value", "standard deviation", "unit"}, rows);
}

std::string rejected(const calib::Calibration& calibration) {
  std::vector<std::vector<std::string>> rows;
  for (const calib::RejectedView& view : calibration.rejected)
    rows.push_back({view.name, view.reason});
  const std::string corners = fmt::format(
      "<p>{} single corners were rejected in the views that are used.</p>\n", calibration.rejected_corners);
  return rows.empty() ? "<p>No view was rejected.</p>\n" + corners
                      : tableElement({"view", "reason"}, rows) + corners;
}

std::string depthTable(const calib::Calibration& calibration) {
  std::vector<std::vector<std::string>> rows;
  for (const calib::DepthDifference& at : calibration.halves.depth) {
    rows.push_back({fmt::format("{:.0f} m", at.distance),
                    fmt::format("{:.3f} m", depthErrorOf(calibration, at.distance)), metresText(at.median),
                    metresText(at.p95)});
  }
  return tableElement({"distance", "depth error if the rows' error were along the row",
                       "two calibrations, each from every other view, differ by (median)", "(95 %)"},
                      rows);
}

}  // namespace

std::string calibrationReport(const calib::Calibration& calibration, const std::string& origin,
                              const ReportPair& pair) {
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta "
      "charset=\"utf-8\"><title>Calibration</title><style>{}</style></head>"
      "<body>\n<h1>Calibration of two cameras</h1>\n<p>{}</p>\n<p>Board {}, images of {}x{} px, {} views "
      "used, model "
      "{}, baseline "
      "{:.2f} mm.</p>\n",
      kStyle, escaped(origin), escaped(calib::boardSpecText(calibration.board)), calibration.image_size.width,
      calibration.image_size.height, calibration.views.size(), calib::modelName(calibration.result().model),
      1000.0 * calibration.rig().baseline());
  html += section("Validation", verdict(calibration));
  html += section(
      "Image coverage",
      figure(coveragePlot(calibration, &calib::BoardView::left, &calib::ViewResiduals::left),
             fmt::format("left: {:.0f} % of the cells", 100.0 * calibration.left_coverage.share())) +
          figure(coveragePlot(calibration, &calib::BoardView::right, &calib::ViewResiduals::right),
                 fmt::format("right: {:.0f} % of the cells", 100.0 * calibration.right_coverage.share())) +
          "<p>Residual of each corner in standard deviations. Green: below 2, orange: below 3.5, red: "
          "larger.</p>\n");
  html += section("Residuals by view", residualPlot(calibration));
  if (!pair.left.empty()) {
    html += section("A rectified pair", imageElement(rectifiedPair(calibration, pair.left, pair.right),
                                                     "view " + pair.name + ", rectified") +
                                            "<p>Each line must cross the same points in both images.</p>\n");
  }
  html += section("Depth error", depthPlot(calibration) + depthTable(calibration));
  html += section("Models", models(calibration));
  html += section("Uncertainty", uncertainties(calibration));
  html += section("Rejected views", rejected(calibration));
  return html + "</body></html>\n";
}

}  // namespace cartvo
