#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <opencv2/core/mat.hpp>

// Drawings of lines, areas, dots and text, written as SVG or PNG.

namespace cartvo {

/// Colour, 8 bits a channel.
struct DrawingColour {
  std::uint8_t red = 0, green = 0, blue = 0;

  friend bool operator==(const DrawingColour&, const DrawingColour&) = default;
};

/// How a line is drawn.
enum class LinePattern : std::uint8_t { solid, dashed };

/// Names of colours in an HTML page, such as "var(--ink)", for colours that depend on the page's scheme.
using ColourNames = std::vector<std::pair<DrawingColour, std::string>>;

/// Position of a text's reference point.
enum class TextAnchor : std::uint8_t { start, middle, end };

/// A drawing on white; coordinates and widths are px, y downwards. Later elements cover earlier ones.
class Drawing {
 public:
  Drawing(int width, int height) : Drawing(width, height, 13) {}
  /// `letter_size`: size of the font, px.
  Drawing(int width, int height, int letter_size)
      : width_(width), height_(height), letter_size_(letter_size) {}

  /// Line through all points.
  void addLine(std::vector<cv::Point2d> points, DrawingColour colour, double width, double opacity = 1.0);
  void addLine(std::vector<cv::Point2d> points, DrawingColour colour, double width, LinePattern pattern);
  /// Filled polygon without an outline.
  void addArea(std::vector<cv::Point2d> points, DrawingColour colour, double opacity);
  /// Circle; `line_width` 0: filled.
  void addCircle(cv::Point2d centre, double radius, DrawingColour colour, double line_width);
  /// Text with its baseline at `at`.
  void addText(cv::Point2d at, TextAnchor anchor, std::string letters, DrawingColour colour = {});

  /// Enlarges this drawing by another one below it.
  void addBelow(const Drawing& other);

  std::string svg() const;
  /// SVG element for an HTML page: without a background, with `title` for screen readers, and with the page's
  /// colours where they have a name.
  std::string svgElement(const std::string& title, const ColourNames& colours) const;
  /// Picture (CV_8UC3, BGR).
  cv::Mat picture() const { return picture(1); }
  /// Picture of `scale` times the drawing's size.
  cv::Mat picture(int scale) const;

 private:
  struct Line {
    std::vector<cv::Point2d> points;
    DrawingColour colour;
    double width, opacity;
    LinePattern pattern;
  };
  struct Area {
    std::vector<cv::Point2d> points;
    DrawingColour colour;
    double opacity;
  };
  struct Circle {
    cv::Point2d centre;
    double radius;
    DrawingColour colour;
    double line_width;
  };
  struct Text {
    cv::Point2d at;
    TextAnchor anchor;
    std::string letters;
    DrawingColour colour;
  };

  static std::string svgOf(const Line& line, const ColourNames& colours);
  static std::string svgOf(const Area& area, const ColourNames& colours);
  static std::string svgOf(const Circle& circle, const ColourNames& colours);
  static std::string svgOf(const Text& text, const ColourNames& colours);
  std::string svgElements(const ColourNames& colours) const;

  int width_, height_, letter_size_;
  std::vector<std::variant<Line, Area, Circle, Text>> elements_;
};

/// Throws std::invalid_argument unless the file is named .svg or .png. For use before long work.
void checkDrawingName(const std::filesystem::path& file);

/// Writes a drawing as .svg or .png, by the file's name, see writeResultFile. A .png has twice the drawing's
/// size. Throws as checkDrawingName does.
void writeDrawing(const std::filesystem::path& file, const Drawing& drawing);

}  // namespace cartvo
