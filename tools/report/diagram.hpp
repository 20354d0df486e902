#pragma once

#include <string>
#include <vector>

namespace cartvo {

/// A curve of a diagram.
struct DiagramCurve {
  struct Point {
    double x, y;
  };
  std::vector<Point> points;
  std::string colour;  ///< SVG colour
  double width = 1.0, opacity = 1.0;
};

/// A diagram in an SVG: logarithmic y axis whose full decades contain all values, linear x axis.
struct Diagram {
  std::string title, x_title;
  double x_step = 1.0;                                      ///< between grid lines
  double left = 0.0, top = 0.0, width = 0.0, height = 0.0;  ///< of the frame, px
  std::vector<DiagramCurve> curves;
};

/// SVG elements of a diagram. The x axis begins at 0.
std::string svgDiagram(const Diagram& diagram);

/// SVG text element; `anchor`: start, middle or end.
std::string svgText(double x, double y, const char* anchor, const std::string& letters);

/// Legend entry: a line that starts at (x, y), and its name.
std::string svgLegendEntry(double x, double y, const std::string& colour, const std::string& name);

/// Complete SVG file of `elements` on a white background.
std::string svgFile(int width, int height, const std::string& elements);

}  // namespace cartvo
