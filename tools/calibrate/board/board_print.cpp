// Printing of a board's sheet with cairo: one drawing, with a unit of 1 mm, on PDF, SVG and PNG surfaces.
#include "tools/calibrate/board/board_print.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <stdexcept>

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>

#include "calib/board/board_spec.hpp"
#include "common/atomic_file.hpp"

namespace cartvo::calibrate {
namespace {

constexpr double kMillimetresPerInch = 25.4, kPointsPerInch = 72.0;         // PDF: 1 pt = 1/72 inch
constexpr double kLineWidth = 0.15, kLetterSize = 3.0, kLineSpacing = 4.0;  // mm

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Context = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

cairo_status_t append(void* text, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

void check(cairo_status_t status) {
  if (status != CAIRO_STATUS_SUCCESS) {
    throw std::runtime_error(std::string("the board cannot be drawn: ") + cairo_status_to_string(status));
  }
}

/// Draws the pattern in one fill, so that no renderer shows seams between touching black areas.
void drawPattern(cairo_t* context, const BoardSheet& sheet) {
  constexpr double kMillimetresPerMetre = 1000.0;
  for (const cv::Rect2d& metres : calib::boardBlackRectangles(sheet.board)) {
    cairo_rectangle(context, sheet.pattern.x + kMillimetresPerMetre * metres.x,
                    sheet.pattern.y + kMillimetresPerMetre * metres.y, kMillimetresPerMetre * metres.width,
                    kMillimetresPerMetre * metres.height);
  }
  cairo_fill(context);
}

void drawLine(cairo_t* context, cv::Point2d from, cv::Point2d to) {
  cairo_move_to(context, from.x, from.y);
  cairo_line_to(context, to.x, to.y);
}

void drawText(cairo_t* context, cv::Point2d at, const std::string& letters) {
  cairo_move_to(context, at.x, at.y);
  cairo_show_text(context, letters.c_str());
}

/// Draws a ruler from `zero` along `direction`: a stroke for each mm, longer at 5 and 10 mm, towards `away`.
void drawRuler(cairo_t* context, cv::Point2d zero, cv::Point2d direction, cv::Point2d away, double length) {
  drawLine(context, zero, zero + length * direction);
  const int millimetres = static_cast<int>(std::lround(length));
  for (int at = 0; at <= millimetres; ++at) {
    constexpr double kShort = 1.5, kMiddle = 2.5, kLong = 4.0;
    const double stroke = at % 10 == 0 ? kLong : at % 5 == 0 ? kMiddle : kShort;
    const cv::Point2d foot = zero + at * direction;
    drawLine(context, foot, foot + stroke * away);
  }
  cairo_stroke(context);
}

void drawRulers(cairo_t* context, const BoardSheet& sheet) {
  constexpr double kNumberOffset = 7.5;  // mm, from the scale to the baseline of its numbers
  const cv::Rect2d& across = sheet.horizontal_ruler;
  drawRuler(context, across.tl(), {1.0, 0.0}, {0.0, 1.0}, across.width);
  const cv::Rect2d& up = sheet.vertical_ruler;
  const cv::Point2d zero = up.br();
  drawRuler(context, zero, {0.0, -1.0}, {-1.0, 0.0}, up.height);
  drawText(context, across.tl() + cv::Point2d(0.5, kNumberOffset), "0");
  drawText(context, across.tl() + cv::Point2d(across.width + 1.0, kNumberOffset),
           std::to_string(std::lround(across.width)) + " mm");
  drawText(context, {up.x, up.y - 1.0}, std::to_string(std::lround(up.height)) + " mm");
}

std::string millimetres(cv::Size2d size) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.1f x %.1f mm", size.width, size.height);
  return text.data();
}

void drawNotes(cairo_t* context, const BoardSheet& sheet) {
  const std::string spec = calib::boardSpecText(sheet.board);
  drawText(context, sheet.text + cv::Point2d(0.0, kLineSpacing - 0.5),
           "cartvo calibrate --board " + spec + "    pattern " + millimetres(sheet.pattern.size()));
  drawText(context, sheet.text + cv::Point2d(0.0, 2.0 * kLineSpacing - 0.5),
           "Print at 100 %, hold a ruler against both scales, mount it flat, and give --board the sides as "
           "measured.");
}

/// Draws the whole sheet. `units_per_mm`: resolution of the surface.
void drawSheet(cairo_surface_t* surface, const BoardSheet& sheet, double units_per_mm) {
  const Context owner(cairo_create(surface), &cairo_destroy);
  cairo_t* const context = owner.get();
  cairo_scale(context, units_per_mm, units_per_mm);
  cairo_set_source_rgb(context, 1.0, 1.0, 1.0);
  cairo_paint(context);
  cairo_set_source_rgb(context, 0.0, 0.0, 0.0);
  cairo_set_line_width(context, kLineWidth);
  cairo_select_font_face(context, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(context, kLetterSize);
  drawPattern(context, sheet);
  drawRulers(context, sheet);
  drawNotes(context, sheet);
  cairo_show_page(context);
  check(cairo_status(context));
}

std::string pdf(const BoardSheet& sheet) {
  constexpr double kPointsPerMillimetre = kPointsPerInch / kMillimetresPerInch;
  std::string bytes;
  const cv::Size2d points = sheet.page.size * kPointsPerMillimetre;
  const Surface surface(cairo_pdf_surface_create_for_stream(append, &bytes, points.width, points.height),
                        &cairo_surface_destroy);
  // Without the creation date the same board gives the same bytes.
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, nullptr);
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE,
                                 calib::boardSpecText(sheet.board).c_str());
  drawSheet(surface.get(), sheet, kPointsPerMillimetre);
  cairo_surface_finish(surface.get());
  check(cairo_surface_status(surface.get()));
  return bytes;
}

std::string svg(const BoardSheet& sheet) {
  std::string bytes;
  const Surface surface(
      cairo_svg_surface_create_for_stream(append, &bytes, sheet.page.size.width, sheet.page.size.height),
      &cairo_surface_destroy);
  cairo_svg_surface_set_document_unit(surface.get(), CAIRO_SVG_UNIT_MM);
  drawSheet(surface.get(), sheet, 1.0);
  cairo_surface_finish(surface.get());
  check(cairo_surface_status(surface.get()));
  return bytes;
}

std::string png(const BoardSheet& sheet, double dots_per_inch) {
  const double pixels_per_mm = dots_per_inch / kMillimetresPerInch;
  const Surface surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24,
                                 static_cast<int>(std::lround(sheet.page.size.width * pixels_per_mm)),
                                 static_cast<int>(std::lround(sheet.page.size.height * pixels_per_mm))),
      &cairo_surface_destroy);
  drawSheet(surface.get(), sheet, pixels_per_mm);
  std::string bytes;
  check(cairo_surface_write_to_png_stream(surface.get(), append, &bytes));
  return bytes;
}

}  // namespace

std::string printedBoard(const BoardSheet& sheet, const std::string& extension, double dots_per_inch) {
  if (extension == ".pdf") return pdf(sheet);
  if (extension == ".svg") return svg(sheet);
  if (extension == ".png") return png(sheet, dots_per_inch);
  throw std::invalid_argument("a board is written as .pdf, .svg or .png, not '" + extension + "'");
}

void printBoard(const BoardSheet& sheet, const std::filesystem::path& file, double dots_per_inch) {
  writeResultFile(file, printedBoard(sheet, file.extension(), dots_per_inch));
}

}  // namespace cartvo::calibrate
