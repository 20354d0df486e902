#pragma once

#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "tools/report/drawing.hpp"

namespace cartvo {

/// A curve of a diagram.
struct DiagramCurve {
  std::vector<cv::Point2d> points;
  DrawingColour colour;
  double width = 1.0, opacity = 1.0;
};

/// A diagram in a drawing: logarithmic y axis whose full decades contain all values, linear x axis.
struct Diagram {
  std::string title, x_title;
  double x_step = 1.0;                                      ///< between grid lines
  double left = 0.0, top = 0.0, width = 0.0, height = 0.0;  ///< of the frame, px
  std::vector<DiagramCurve> curves;
};

/// Adds a diagram. The x axis begins at 0.
void addDiagram(Drawing& drawing, const Diagram& diagram);

/// Adds a legend entry: a line that starts at `at`, and its name.
void addLegendEntry(Drawing& drawing, cv::Point2d at, DrawingColour colour, const std::string& name);

}  // namespace cartvo
