// Round values on the axes of plots, and curves with fewer points.
#include "tools/report/axis.hpp"

#include <algorithm>
#include <cmath>

#include "tools/report/table.hpp"

namespace cartvo {

double roundStep(double range, int parts) {
  const double rough = std::max(range, 1e-9) / parts;
  const double decade = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * decade >= rough) return factor * decade;
  }
  return 10.0 * decade;
}

std::string tickLabel(double value, double step) {
  const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  return fixed(std::abs(value) < 1e-9 ? 0.0 : value, decimals);
}

namespace {

using Points = std::vector<cv::Point2d>;

bool isFinite(const cv::Point2d& point) {
  return std::isfinite(point.x) && std::isfinite(point.y);
}

long columnOf(const cv::Point2d& point) {
  return std::lround(2.0 * point.x);
}

/// Adds the points of [first, last), which lie in one column.
void addColumn(Points::const_iterator first, Points::const_iterator last, Points& part) {
  constexpr std::ptrdiff_t kMaxPoints = 4;
  if (last - first <= kMaxPoints) {
    part.insert(part.end(), first, last);
    return;
  }
  auto [low, high] = std::minmax_element(first, last, [](const auto& a, const auto& b) { return a.y < b.y; });
  if (high < low) std::swap(low, high);
  for (const auto& kept : {first, low, high, std::prev(last)})
    part.push_back(*kept);
}

}  // namespace

std::vector<Points> visibleParts(const Points& pixels) {
  std::vector<Points> parts;
  auto point = pixels.begin();
  while (point != pixels.end()) {
    point = std::find_if(point, pixels.end(), isFinite);
    const auto end = std::find_if_not(point, pixels.end(), isFinite);
    if (point != end) parts.emplace_back();
    while (point != end) {
      const long column = columnOf(*point);
      const auto next =
          std::find_if(point, end, [&](const auto& other) { return columnOf(other) != column; });
      addColumn(point, next, parts.back());
      point = next;
    }
  }
  return parts;
}

}  // namespace cartvo
