#pragma once

#include <string>
#include <vector>

namespace cartvo {

/// A line of a diagram.
struct DiagramCurve {
  struct Point {
    double x, y;
  };
  std::vector<Point> points;
  std::string colour;  ///< as SVG takes it
  double width = 1.0, opacity = 1.0;
};

/// One diagram in an SVG: values on a logarithmic axis, in decades that hold all of them, over a linear one.
struct Diagram {
  std::string title, x_title;
  double x_step = 1.0;                                      ///< between the marks
  double left = 0.0, top = 0.0, width = 0.0, height = 0.0;  ///< of the frame, px
  std::vector<DiagramCurve> curves;
};

/// The SVG elements of a diagram. The axis of x begins at 0.
std::string svgDiagram(const Diagram& diagram);

/// An SVG text; `anchor`: start, middle or end.
std::string svgText(double x, double y, const char* anchor, const std::string& letters);

/// A stroke of a legend with its name, from x on.
std::string svgLegendEntry(double x, double y, const std::string& colour, const std::string& name);

/// A whole SVG file around such elements, on white.
std::string svgFile(int width, int height, const std::string& elements);

}  // namespace cartvo
