// Draws lines, areas, circles and text with cairo into a picture.
#include "tools/report/canvas.hpp"

#include <numbers>
#include <stdexcept>

#include <opencv2/imgproc.hpp>

namespace cartvo {

Canvas::Canvas(int width, int height, int scale, int letter_size)
    : surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, scale * width, scale * height),
               cairo_surface_destroy),
      context_(cairo_create(surface_.get()), cairo_destroy) {
  if (const cairo_status_t status = cairo_status(context_.get()); status != CAIRO_STATUS_SUCCESS)
    throw std::runtime_error(std::string("the plot cannot be drawn: ") + cairo_status_to_string(status));
  cairo_scale(context_.get(), scale, scale);
  cairo_set_source_rgb(context_.get(), 1.0, 1.0, 1.0);
  cairo_paint(context_.get());
  cairo_set_line_join(context_.get(), CAIRO_LINE_JOIN_ROUND);
  cairo_select_font_face(context_.get(), "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(context_.get(), letter_size);
}

void Canvas::line(const std::vector<cv::Point2d>& points, DrawingColour colour, double width,
                  double opacity) {
  choose(colour, opacity);
  cairo_set_line_width(context_.get(), width);
  trace(points);
  cairo_stroke(context_.get());
}

void Canvas::area(const std::vector<cv::Point2d>& points, DrawingColour colour, double opacity) {
  choose(colour, opacity);
  trace(points);
  cairo_fill(context_.get());
}

void Canvas::circle(const cv::Point2d& centre, double radius, DrawingColour colour, double line_width) {
  choose(colour, 1.0);
  cairo_new_sub_path(context_.get());
  cairo_arc(context_.get(), centre.x, centre.y, radius, 0.0, 2.0 * std::numbers::pi);
  if (line_width <= 0.0) return cairo_fill(context_.get());
  cairo_set_line_width(context_.get(), line_width);
  cairo_stroke(context_.get());
}

void Canvas::text(const cv::Point2d& at, TextAnchor anchor, const std::string& letters,
                  DrawingColour colour) {
  cairo_text_extents_t extents;
  cairo_text_extents(context_.get(), letters.c_str(), &extents);
  const double share = anchor == TextAnchor::start ? 0.0 : anchor == TextAnchor::middle ? 0.5 : 1.0;
  choose(colour, 1.0);
  cairo_move_to(context_.get(), at.x - share * extents.x_advance, at.y);
  cairo_show_text(context_.get(), letters.c_str());
}

Canvas::Canvas(const cv::Mat& background, int letter_size)
    : Canvas(background.cols, background.rows, 1, letter_size) {
  cairo_surface_flush(surface_.get());
  cv::cvtColor(background, pixels(), cv::COLOR_BGR2BGRA);
  cairo_surface_mark_dirty(surface_.get());
}

cv::Mat Canvas::pixels() const {
  return {cairo_image_surface_get_height(surface_.get()), cairo_image_surface_get_width(surface_.get()),
          CV_8UC4, cairo_image_surface_get_data(surface_.get()),
          static_cast<std::size_t>(cairo_image_surface_get_stride(surface_.get()))};
}

cv::Mat Canvas::picture() {
  cairo_surface_flush(surface_.get());
  cv::Mat picture;
  cv::cvtColor(pixels(), picture, cv::COLOR_BGRA2BGR);
  return picture;
}

void Canvas::trace(const std::vector<cv::Point2d>& points) {
  cairo_new_path(context_.get());
  for (const cv::Point2d& point : points)
    cairo_line_to(context_.get(), point.x, point.y);
}

void Canvas::choose(DrawingColour colour, double opacity) {
  constexpr double kFull = 255.0;
  cairo_set_source_rgba(context_.get(), colour.red / kFull, colour.green / kFull, colour.blue / kFull,
                        opacity);
}

}  // namespace cartvo
