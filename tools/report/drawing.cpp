// Drawings of lines, dots and text, written as SVG or PNG.
#include "tools/report/drawing.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/atomic_file.hpp"

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

std::string escaped(const std::string& letters) {
  std::string text;
  for (const char letter : letters) {
    if (letter == '<') {
      text += "&lt;";
    } else if (letter == '&') {
      text += "&amp;";
    } else {
      text += letter;
    }
  }
  return text;
}

/// Picture at twice the size, which smooths lines and OpenCV's letters when it is reduced.
class Canvas {
 public:
  Canvas(int width, int height)
      : image_(cv::Size(width, height) * kOversampling, CV_8UC3, cv::Scalar::all(255)) {}

  void line(const std::vector<cv::Point2d>& points, const cv::Scalar& colour, double width) {
    std::vector<cv::Point> scaled;
    scaled.reserve(points.size());
    for (const cv::Point2d& point : points)
      scaled.push_back(fixed(point));
    cv::polylines(image_, scaled, false, colour, thickness(width), cv::LINE_AA, kShift);
  }
  void circle(const cv::Point2d& centre, double radius, const cv::Scalar& colour, double line_width) {
    cv::circle(image_, fixed(centre), static_cast<int>(radius * kOversampling * (1 << kShift)), colour,
               line_width > 0.0 ? thickness(line_width) : static_cast<int>(cv::FILLED), cv::LINE_AA, kShift);
  }
  void text(cv::Point2d at, TextAnchor anchor, const std::string& letters, const cv::Scalar& colour) {
    constexpr double kSize = 0.5 * kOversampling;
    const int width = cv::getTextSize(letters, cv::FONT_HERSHEY_SIMPLEX, kSize, kOversampling, nullptr).width;
    cv::Point origin(static_cast<int>(at.x * kOversampling), static_cast<int>(at.y * kOversampling));
    if (anchor != TextAnchor::start) origin.x -= anchor == TextAnchor::end ? width : width / 2;
    cv::putText(image_, letters, origin, cv::FONT_HERSHEY_SIMPLEX, kSize, colour, kOversampling, cv::LINE_AA);
  }
  cv::Mat finished() const {
    cv::Mat small;
    cv::resize(image_, small, image_.size() / kOversampling, 0, 0, cv::INTER_AREA);
    return small;
  }

 private:
  static constexpr int kOversampling = 2;
  static constexpr int kShift = 4;

  static int thickness(double width) {
    return std::max(1, static_cast<int>(std::lround(width * kOversampling)));
  }
  static cv::Point fixed(const cv::Point2d& point) {
    const double scale = kOversampling * (1 << kShift);
    return {static_cast<int>(std::lround(point.x * scale)), static_cast<int>(std::lround(point.y * scale))};
  }

  cv::Mat image_;
};

cv::Scalar onWhite(DrawingColour colour, double opacity) {
  const auto mixed = [opacity](std::uint8_t channel) { return 255.0 + opacity * (channel - 255.0); };
  return {mixed(colour.blue), mixed(colour.green), mixed(colour.red)};
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

void Drawing::addCircle(cv::Point2d centre, double radius, DrawingColour colour, double line_width) {
  elements_.emplace_back(Circle{centre, radius, colour, line_width});
}

void Drawing::addText(cv::Point2d at, TextAnchor anchor, std::string letters, DrawingColour colour) {
  elements_.emplace_back(Text{at, anchor, std::move(letters), colour});
}

std::string Drawing::svgOf(const Line& line) {
  std::string svg = "<path d=\"";
  for (std::size_t i = 0; i < line.points.size(); ++i)
    svg += format(i == 0 ? "M%.1f %.1f" : "L%.1f %.1f", line.points[i].x, line.points[i].y);
  svg += format(R"(" fill="none" stroke="%s" stroke-width="%g")", hex(line.colour).c_str(), line.width);
  if (line.opacity < 1.0) svg += format(R"( stroke-opacity="%g")", line.opacity);
  return svg + "/>\n";
}

std::string Drawing::svgOf(const Circle& circle) {
  std::string svg =
      format(R"(<circle cx="%.1f" cy="%.1f" r="%g")", circle.centre.x, circle.centre.y, circle.radius);
  const std::string colour = hex(circle.colour);
  svg += circle.line_width > 0.0
             ? format(R"( fill="none" stroke="%s" stroke-width="%g")", colour.c_str(), circle.line_width)
             : format(R"( fill="%s")", colour.c_str());
  return svg + "/>\n";
}

std::string Drawing::svgOf(const Text& text) {
  constexpr std::array kAnchors{"start", "middle", "end"};
  std::string svg = format(R"(<text x="%.1f" y="%.1f" text-anchor="%s")", text.at.x, text.at.y,
                           kAnchors[static_cast<std::size_t>(text.anchor)]);
  if (text.colour != DrawingColour{}) svg += format(R"( fill="%s")", hex(text.colour).c_str());
  return svg + ">" + escaped(text.letters) + "</text>\n";
}

std::string Drawing::svg() const {
  std::string svg = format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" font-family=\"sans-serif\" "
      "font-size=\"13\">\n<rect width=\"%d\" height=\"%d\" fill=\"#fff\"/>\n",
      width_, height_, width_, height_);
  for (const auto& element : elements_)
    svg += std::visit([](const auto& shape) { return svgOf(shape); }, element);
  return svg + "</svg>\n";
}

cv::Mat Drawing::picture() const {
  Canvas canvas(width_, height_);
  const Overloaded draw{
      [&](const Line& line) { canvas.line(line.points, onWhite(line.colour, line.opacity), line.width); },
      [&](const Circle& circle) {
        canvas.circle(circle.centre, circle.radius, onWhite(circle.colour, 1.0), circle.line_width);
      },
      [&](const Text& text) { canvas.text(text.at, text.anchor, text.letters, onWhite(text.colour, 1.0)); }};
  for (const auto& element : elements_)
    std::visit(draw, element);
  return canvas.finished();
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
  std::vector<unsigned char> png;
  if (!cv::imencode(".png", drawing.picture(), png))
    throw std::runtime_error(file.string() + ": the plot cannot be encoded");
  writeResultFile(file, {reinterpret_cast<const char*>(png.data()), png.size()});
}

}  // namespace cartvo
