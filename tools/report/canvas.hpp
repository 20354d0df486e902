#pragma once

#include <memory>
#include <string>
#include <vector>

#include <cairo.h>
#include <opencv2/core/mat.hpp>

#include "tools/report/drawing.hpp"

namespace cartvo {

/// Picture that cairo draws on. Coordinates and widths are px of the drawing.
class Canvas {
 public:
  /// White at first. `scale`: pixels of the picture per px of the drawing. Throws std::runtime_error if cairo
  /// cannot make it.
  Canvas(int width, int height, int scale, int letter_size);

  /// A copy of `background` (CV_8UC3, BGR) at first.
  Canvas(const cv::Mat& background, int letter_size);

  void line(const std::vector<cv::Point2d>& points, DrawingColour colour, double width, double opacity);
  void area(const std::vector<cv::Point2d>& points, DrawingColour colour, double opacity);
  /// `line_width` 0: filled.
  void circle(const cv::Point2d& centre, double radius, DrawingColour colour, double line_width);
  void text(const cv::Point2d& at, TextAnchor anchor, const std::string& letters, DrawingColour colour);

  /// Picture so far (CV_8UC3, BGR).
  cv::Mat picture();

 private:
  /// The surface's pixels, CV_8UC4.
  cv::Mat pixels() const;
  void trace(const std::vector<cv::Point2d>& points);
  void choose(DrawingColour colour, double opacity);

  std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface_;
  std::unique_ptr<cairo_t, decltype(&cairo_destroy)> context_;
};

}  // namespace cartvo
