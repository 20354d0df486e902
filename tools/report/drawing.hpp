#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include <opencv2/core/mat.hpp>

// Drawings of lines, dots and text, written as SVG or PNG.

namespace cartvo {

/// Colour, 8 bits a channel.
struct DrawingColour {
  std::uint8_t red = 0, green = 0, blue = 0;

  friend bool operator==(const DrawingColour&, const DrawingColour&) = default;
};

/// Position of a text's reference point.
enum class TextAnchor : std::uint8_t { start, middle, end };

/// A drawing on white; coordinates and widths are px, y downwards. Later elements cover earlier ones.
class Drawing {
 public:
  Drawing(int width, int height) : width_(width), height_(height) {}

  /// Line through all points.
  void addLine(std::vector<cv::Point2d> points, DrawingColour colour, double width, double opacity = 1.0);
  /// Circle; `line_width` 0: filled.
  void addCircle(cv::Point2d centre, double radius, DrawingColour colour, double line_width);
  /// Text with its baseline at `at`.
  void addText(cv::Point2d at, TextAnchor anchor, std::string letters, DrawingColour colour = {});

  std::string svg() const;
  /// Picture (CV_8UC3, BGR). Opacity mixes a colour with white.
  cv::Mat picture() const;

 private:
  struct Line {
    std::vector<cv::Point2d> points;
    DrawingColour colour;
    double width, opacity;
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

  static std::string svgOf(const Line& line);
  static std::string svgOf(const Circle& circle);
  static std::string svgOf(const Text& text);

  int width_, height_;
  std::vector<std::variant<Line, Circle, Text>> elements_;
};

/// Throws std::invalid_argument unless the file is named .svg or .png. For use before long work.
void checkDrawingName(const std::filesystem::path& file);

/// Writes a drawing as .svg or .png, by the file's name, see writeResultFile. Throws as checkDrawingName
/// does.
void writeDrawing(const std::filesystem::path& file, const Drawing& drawing);

}  // namespace cartvo
