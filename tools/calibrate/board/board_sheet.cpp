// Layout of a board, its rulers and its text on a page.
#include "tools/calibrate/board/board_sheet.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <stdexcept>

namespace cartvo::calibrate {
namespace {

// mm. The unprintable margin of most printers is below 5 mm. With these values a chessboard of 9x6 corners
// and squares of 25 mm fits on A4.
constexpr double kMargin = 6.0, kGap = 4.0;
constexpr double kRulerWidth = 8.0, kTextHeight = 8.0;
constexpr double kLeftStrip = kMargin + kRulerWidth + kGap,
                 kBottomStrip = kMargin + kTextHeight + kRulerWidth + kGap;
constexpr double kMinRulerLength = 10.0, kRulerStep = 10.0, kMaxRulerLength = 200.0;

/// Paper sizes of ISO 216, in portrait orientation.
const std::array<Page, 5> kPages{{{"A4", {210.0, 297.0}},
                                  {"A3", {297.0, 420.0}},
                                  {"A2", {420.0, 594.0}},
                                  {"A1", {594.0, 841.0}},
                                  {"A0", {841.0, 1189.0}}}};

std::string format(const char* pattern, auto... values) {
  char text[200];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

cv::Size2d extentOf(const calib::BoardSpec& board) {
  const Eigen::Vector2d extent = 1000.0 * calib::boardExtent(board);
  return {extent.x(), extent.y()};
}

cv::Size2d roomOn(cv::Size2d page) {
  return {page.width - kLeftStrip - kMargin, page.height - kMargin - kBottomStrip};
}

bool fits(cv::Size2d extent, cv::Size2d page) {
  constexpr double kRounding = 1e-6;
  const cv::Size2d room = roomOn(page);
  return extent.width <= room.width + kRounding && extent.height <= room.height + kRounding;
}

/// The page in the orientation that the board fits on, landscape first. std::nullopt if it fits in neither.
std::optional<Page> turnedFor(cv::Size2d extent, const Page& upright) {
  const Page lying{upright.name, {upright.size.height, upright.size.width}};
  if (fits(extent, lying.size)) return lying;
  if (fits(extent, upright.size)) return upright;
  return std::nullopt;
}

[[noreturn]] void failTooLarge(cv::Size2d extent, const Page& page) {
  const cv::Size2d room = roomOn(page.size);
  throw std::invalid_argument(format(
      "the board is %.1f x %.1f mm and does not fit on %s, which has room for %.1f x %.1f mm", extent.width,
      extent.height, page.name.c_str(), std::max(0.0, room.width), std::max(0.0, room.height)));
}

Page smallestPage(cv::Size2d extent) {
  for (const Page& upright : kPages) {
    if (const std::optional<Page> page = turnedFor(extent, upright)) return *page;
  }
  const Page& largest = kPages.back();
  failTooLarge(extent, {largest.name, {largest.size.height, largest.size.width}});
}

Page customPage(const std::string& name) {
  constexpr double kMinSide = 50.0, kMaxSide = 5000.0;  // mm
  Page page;
  char more = 0;
  if (std::sscanf(name.c_str(), "%lfx%lf%c", &page.size.width, &page.size.height, &more) != 2) {
    throw std::invalid_argument(
        "page '" + name + "': expected A4, A3, A2, A1, A0, auto, or WIDTHxHEIGHT in mm, such as 600x400");
  }
  for (const double side : {page.size.width, page.size.height}) {
    if (!(side >= kMinSide && side <= kMaxSide))
      throw std::invalid_argument("page '" + name + "': each side must have 50 to 5000 mm");
  }
  page.name = name + " mm";
  return page;
}

Page pageFor(cv::Size2d extent, const std::string& name) {
  if (name == "auto") return smallestPage(extent);
  const auto* const upright =
      std::find_if(kPages.begin(), kPages.end(), [&](const Page& page) { return page.name == name; });
  if (upright == kPages.end()) {
    Page page = customPage(name);
    if (!fits(extent, page.size)) failTooLarge(extent, page);
    return page;
  }
  if (const std::optional<Page> page = turnedFor(extent, *upright)) return *page;
  failTooLarge(extent, {upright->name, {upright->size.height, upright->size.width}});
}

/// Length of a ruler along a side of the pattern, in whole centimetres, mm.
double rulerLength(double side) {
  return std::clamp(std::floor(side / kRulerStep) * kRulerStep, kMinRulerLength, kMaxRulerLength);
}

}  // namespace

BoardSheet layOutBoard(const calib::BoardSpec& board, const std::string& page) {
  const cv::Size2d extent = extentOf(board);
  BoardSheet sheet;
  sheet.board = board;
  sheet.page = pageFor(extent, page);
  const cv::Size2d room = roomOn(sheet.page.size);
  sheet.pattern = {
      {kLeftStrip + (room.width - extent.width) / 2.0, kMargin + (room.height - extent.height) / 2.0},
      extent};
  const double pattern_bottom = sheet.pattern.y + sheet.pattern.height;
  const double ruler_height = rulerLength(extent.height);
  sheet.horizontal_ruler = {sheet.pattern.x, sheet.page.size.height - kBottomStrip + kGap,
                            rulerLength(extent.width), kRulerWidth};
  sheet.vertical_ruler = {kMargin, pattern_bottom - ruler_height, kRulerWidth, ruler_height};
  sheet.text = {kLeftStrip, sheet.page.size.height - kMargin - kTextHeight};
  return sheet;
}

}  // namespace cartvo::calibrate
