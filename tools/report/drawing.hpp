#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include <opencv2/core/mat.hpp>

// Drawings of lines and text, written as SVG or PNG.

namespace cartvo {

/// Colour, 8 bits a channel.
struct DrawingColour {
  std::uint8_t red = 0, green = 0, blue = 0;
};

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
  /// Text with its baseline at `at`.
  void addText(cv::Point2d at, TextAnchor anchor, std::string letters, DrawingColour colour = {});

  std::string svg() const;
  /// Picture (CV_8UC3, BGR).
  cv::Mat picture() const { return picture(1); }
  /// Picture of `scale` times the drawing's size.
  cv::Mat picture(int scale) const;

 private:
  struct Line {
    std::vector<cv::Point2d> points;
    DrawingColour colour;
    double width, opacity;
  };
  struct Text {
    cv::Point2d at;
    TextAnchor anchor;
    std::string letters;
    DrawingColour colour;
  };

  static std::string svgOf(const Line& line);
  static std::string svgOf(const Text& text);

  int width_, height_, letter_size_;
  std::vector<std::variant<Line, Text>> elements_;
};

/// Throws std::invalid_argument unless the file is named .svg or .png. For use before long work.
void checkDrawingName(const std::filesystem::path& file);

/// Writes a drawing as .svg or .png, by the file's name, see writeResultFile. A .png has twice the drawing's
/// size. Throws as checkDrawingName does.
void writeDrawing(const std::filesystem::path& file, const Drawing& drawing);

}  // namespace cartvo
