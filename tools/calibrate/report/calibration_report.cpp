// HTML report of a calibration.
#include "tools/calibrate/report/calibration_report.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <opencv2/core/mat.hpp>
#include <opencv2/imgproc.hpp>

#include "calib/rectification/rectifier.hpp"
#include "calib/solver/calibration.hpp"
#include "tools/calibrate/report/calibration_summary.hpp"
#include "tools/report/axis.hpp"
#include "tools/report/html.hpp"

namespace cartvo {
namespace {

// SVG plots of a calibration.

// Plots of a calibration. All but the last are SVG elements.

std::string svg(double width, double height, const std::string& content) {
  return fmt::format(
      "<svg viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "xmlns=\"http://www.w3.org/2000/svg\">\n"
      "{2}</svg>\n",
      width, height, content);
}

std::string line(double x1, double y1, double x2, double y2, const char* colour) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\"/>\n", x1,
                     y1, x2, y2, colour);
}

std::string text(double x, double y, const std::string& words) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"11\">{}</text>\n", x, y, words);
}

std::string rectangle(double x, double y, double width, double height, const char* colour) {
  return fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"/>\n", x,
                     y, width, height, colour);
}

/// Horizontal grid lines from `left` to `right` with their values; `height`: that of a value above the base.
std::string grid(double left, double right, double base, double largest, const char* unit,
                 const std::function<double(double)>& height) {
  const double step = roundStep(largest, 5);
  std::string lines;
  for (int i = 0; i * step <= largest; ++i) {
    const double value = i * step;
    const double y = base - height(value);
    lines += line(left, y, right, y, value == 0.0 ? "#888" : "#ddd") +
             text(2, y + 4.0, tickLabel(value, step) + " " + unit);
  }
  return lines;
}

struct LegendEntry {
  const char* colour;
  const char* words;
};

std::string legend(double x, double y, std::initializer_list<LegendEntry> entries) {
  constexpr double kLetter = 5.6, kMargin = 30.0;  // px
  std::string content;
  for (const LegendEntry& entry : entries) {
    content += rectangle(x, y - 8.0, 9.0, 9.0, entry.colour) + text(x + 13.0, y, entry.words);
    x += kMargin + kLetter * static_cast<double>(std::string_view(entry.words).size());
  }
  return content;
}

/// Corners in one camera's images, coloured by their residual.
std::string coveragePlot(const calib::Calibration& calibration,
                         std::vector<calib::SeenCorner> calib::BoardView::*side,
                         std::vector<Eigen::Vector2d> calib::ViewResiduals::*residuals) {
  constexpr double kWidth = 480.0;
  const double scale = kWidth / calibration.image_size.width, height = scale * calibration.image_size.height;
  const double stddev = calibration.result().corner_stddev;
  std::string content = rectangle(0, 0, kWidth, height, "#f2f2f2");
  for (int column = 1; column < calib::ImageCoverage::kColumns; ++column) {
    const double x = kWidth * column / calib::ImageCoverage::kColumns;
    content += line(x, 0, x, height, "#ddd");
  }
  for (int row = 1; row < calib::ImageCoverage::kRows; ++row) {
    const double y = height * row / calib::ImageCoverage::kRows;
    content += line(0, y, kWidth, y, "#ddd");
  }
  for (std::size_t i = 0; i < calibration.views.size(); ++i) {
    const auto& seen = calibration.views[i].*side;
    for (std::size_t k = 0; k < seen.size(); ++k) {
      const double error = (calibration.residuals[i].*residuals)[k].norm() / stddev;
      const char* const colour = error < 2.0 ? "#2a7" : error < 3.5 ? "#e90" : "#d22";
      content += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"1.6\" fill=\"{}\"/>\n",
                             scale * seen[k].pixel.x(), scale * seen[k].pixel.y(), colour);
    }
  }
  return svg(kWidth, height, content);
}

/// RMS residuals of each view, left and right, and its error when held out.
std::string residualPlot(const calib::Calibration& calibration) {
  constexpr double kHeight = 180.0, kBase = 150.0, kLeft = 44.0, kGroup = 18.0;
  double largest = 0.1;
  for (std::size_t i = 0; i < calibration.views.size(); ++i) {
    largest = std::max({largest, calibration.validation().views[i].rms,
                        calib::residualRms({calibration.residuals[i].left, {}}),
                        calib::residualRms({{}, calibration.residuals[i].right})});
  }
  const double width = kLeft + kGroup * static_cast<double>(calibration.views.size()) + 10.0;
  const auto height = [&](double rms) { return (kBase - 10.0) * rms / largest; };
  std::string content = grid(kLeft, width, kBase, largest, "px", height);
  for (std::size_t i = 0; i < calibration.views.size(); ++i) {
    const double x = kLeft + 2.0 + kGroup * static_cast<double>(i);
    const double left = height(calib::residualRms({calibration.residuals[i].left, {}}));
    const double right = height(calib::residualRms({{}, calibration.residuals[i].right}));
    const double held_out = height(calibration.validation().views[i].rms);
    content += rectangle(x, kBase - left, 4, left, "#27c") +
               rectangle(x + 5, kBase - right, 4, right, "#2a7") +
               rectangle(x + 10, kBase - held_out, 4, held_out, "#bbb");
    if (i % 5 == 0) content += text(x, kBase + 14, std::to_string(i));
  }
  content += legend(kLeft, kBase + 28, {{"#27c", "left"}, {"#2a7", "right"}, {"#bbb", "held out"}});
  return svg(std::max(width, 400.0), kHeight, content);
}

/// Depth error over distance: from the vertical disparity's RMS and from the difference of the two halves.
std::string depthPlot(const calib::Calibration& calibration) {
  constexpr double kWidth = 480.0, kHeight = 240.0, kLeft = 60.0, kBase = 210.0, kTop = 12.0;
  const auto& depth = calibration.halves.depth;
  const double farthest = depth.back().distance;
  double largest = 0.0;
  for (const calib::DepthDifference& at : depth) {
    largest = std::max(largest, depthErrorOf(calibration, at.distance) / at.distance);
    if (std::isfinite(at.p95)) largest = std::max(largest, at.p95 / at.distance);
  }
  const auto x = [&](double distance) { return kLeft + (kWidth - kLeft - 10.0) * distance / farthest; };
  const auto height = [&](double share) { return (kBase - kTop) * share / largest; };
  const auto y = [&](double share) { return kBase - height(share); };
  std::string content = grid(kLeft, kWidth, kBase, 100.0 * largest, "%",
                             [&](double percent) { return height(0.01 * percent); });
  const auto curve = [&](auto share, const char* colour) {
    std::string points;
    for (const calib::DepthDifference& at : depth) {
      if (std::isfinite(share(at))) points += fmt::format("{:.1f},{:.1f} ", x(at.distance), y(share(at)));
    }
    return fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"/>\n", points,
                       colour);
  };
  content += curve(
      [&](const calib::DepthDifference& at) { return depthErrorOf(calibration, at.distance) / at.distance; },
      "#27c");
  content += curve([](const calib::DepthDifference& at) { return at.median / at.distance; }, "#2a7");
  content += curve([](const calib::DepthDifference& at) { return at.p95 / at.distance; }, "#e90");
  for (const calib::DepthDifference& at : depth)
    content += text(x(at.distance) - 14.0, kBase + 14.0, fmt::format("{:.0f} m", at.distance));
  content += legend(kLeft - 50.0, kBase + 27.0,
                    {{"#27c", "if the rows' error were along the row"},
                     {"#2a7", "every other view, median"},
                     {"#e90", "95 %"}});
  return svg(kWidth + 60.0, kHeight, content);
}

/// Both rectified images side by side, with lines along the rows (CV_8UC3).
cv::Mat rectifiedPair(const calib::Calibration& calibration, const cv::Mat& left, const cv::Mat& right) {
  constexpr int kLines = 16, kMaxWidth = 1400;  // px
  const calib::Rig& rig = calibration.rig();
  const calib::Rectifier rectifier(rig, rig.rectification, calib::buildTables(rig, rig.rectification));
  cv::Mat rectified_left, rectified_right, both, colour;
  rectifier.rectifyLeft(left, rectified_left);
  rectifier.rectifyRight(right, rectified_right);
  cv::hconcat(rectified_left, rectified_right, both);
  const double scale = std::min(1.0, static_cast<double>(kMaxWidth) / both.cols);
  cv::resize(both, both, {}, scale, scale, cv::INTER_AREA);
  cv::cvtColor(both, colour, cv::COLOR_GRAY2BGR);
  for (int i = 1; i < kLines; ++i) {
    const int row = colour.rows * i / kLines;
    cv::line(colour, {0, row}, {colour.cols - 1, row},
             i % 2 == 0 ? cv::Scalar(0, 200, 0) : cv::Scalar(0, 120, 255));
  }
  return colour;
}

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
