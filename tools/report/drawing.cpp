// Drawings of lines and text, written as SVG or PNG.
#include "tools/report/drawing.hpp"

#include <array>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include <opencv2/imgcodecs.hpp>

#include "common/atomic_file.hpp"
#include "tools/report/canvas.hpp"
#include "tools/report/html.hpp"

namespace cartvo {
namespace {

std::string format(const char* pattern, auto... values) {
  std::array<char, 400> text{};
  std::snprintf(text.data(), text.size(), pattern, values...);
  return text.data();
}

std::string hex(DrawingColour colour) {
  return format("#%02x%02x%02x", colour.red, colour.green, colour.blue);
}

/// The d of an SVG path.
std::string pathData(const std::vector<cv::Point2d>& points) {
  std::string data;
  for (std::size_t i = 0; i < points.size(); ++i)
    data += format(i == 0 ? "M%.1f %.1f" : "L%.1f %.1f", points[i].x, points[i].y);
  return data;
}

template <typename... Calls>
struct Overloaded : Calls... {
  using Calls::operator()...;
};
template <typename... Calls>
Overloaded(Calls...) -> Overloaded<Calls...>;

}  // namespace

void Drawing::addLine(std::vector<cv::Point2d> points, DrawingColour colour, double width, double opacity) {
  elements_.emplace_back(Line{std::move(points), colour, width, opacity});
}

void Drawing::addText(cv::Point2d at, TextAnchor anchor, std::string letters, DrawingColour colour) {
  elements_.emplace_back(Text{at, anchor, std::move(letters), colour});
}

std::string Drawing::svgOf(const Line& line) {
  std::string svg = "<path d=\"" + pathData(line.points);
  svg += format(R"(" fill="none" stroke="%s" stroke-width="%g")", hex(line.colour).c_str(), line.width);
  if (line.opacity < 1.0) svg += format(R"( stroke-opacity="%g")", line.opacity);
  return svg + "/>\n";
}

std::string Drawing::svgOf(const Text& text) {
  constexpr std::array kAnchors{"start", "middle", "end"};
  std::string svg = format(R"(<text x="%.1f" y="%.1f" text-anchor="%s")", text.at.x, text.at.y,
                           kAnchors[static_cast<std::size_t>(text.anchor)]);
  if (const std::string colour = hex(text.colour); colour != hex({}))
    svg += format(R"( fill="%s")", colour.c_str());
  return svg + ">" + escaped(text.letters) + "</text>\n";
}

std::string Drawing::svg() const {
  std::string svg = format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" font-family=\"sans-serif\" "
      "font-size=\"%d\">\n<rect width=\"%d\" height=\"%d\" fill=\"#fff\"/>\n",
      width_, height_, letter_size_, width_, height_);
  for (const auto& element : elements_)
    svg += std::visit([](const auto& shape) { return svgOf(shape); }, element);
  return svg + "</svg>\n";
}

cv::Mat Drawing::picture(int scale) const {
  Canvas canvas(width_, height_, scale, letter_size_);
  const Overloaded draw{
      [&](const Line& line) { canvas.line(line.points, line.colour, line.width, line.opacity); },
      [&](const Text& text) { canvas.text(text.at, text.anchor, text.letters, text.colour); }};
  for (const auto& element : elements_)
    std::visit(draw, element);
  return canvas.picture();
}

void checkDrawingName(const std::filesystem::path& file) {
  const std::filesystem::path suffix = file.extension();
  if (suffix == ".svg" || suffix == ".png") return;
  throw std::invalid_argument(file.string() + ": a plot is written as .svg or .png, not '" + suffix.string() +
                              "'; name the file so");
}

void writeDrawing(const std::filesystem::path& file, const Drawing& drawing) {
  checkDrawingName(file);
  if (file.extension() == ".svg") return writeResultFile(file, drawing.svg());
  constexpr int kScale = 2;
  std::vector<unsigned char> png;
  if (!cv::imencode(".png", drawing.picture(kScale), png))
    throw std::runtime_error(file.string() + ": the plot cannot be encoded");
  writeResultFile(file, {reinterpret_cast<const char*>(png.data()), png.size()});
}

}  // namespace cartvo
