// SVG plots of a calibration.
#include "tools/calibrate/report/calibration_plots.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <string_view>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "calib/rectification/rectifier.hpp"
#include "tools/calibrate/report/calibration_summary.hpp"
#include "tools/report/axis.hpp"

namespace cartvo {
namespace {

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

}  // namespace

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

}  // namespace cartvo
