// Reduces curves of many points to what is visible.
#include "tools/report/series_reduction.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo {
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

std::vector<Points> visibleAreas(const Points& low, const Points& high) {
  std::vector<Points> areas;
  const auto is_finite = [&](std::size_t i) { return isFinite(low[i]) && isFinite(high[i]); };
  for (std::size_t i = 0; i < low.size(); ++i) {
    if (!is_finite(i)) continue;
    Points lower, upper;
    for (; i < low.size() && is_finite(i); ++i) {
      if (!lower.empty() && columnOf(lower.back()) == columnOf(low[i])) {
        lower.back().y = std::max(lower.back().y, low[i].y);  // px grow downwards
        upper.back().y = std::min(upper.back().y, high[i].y);
      } else {
        lower.push_back(low[i]);
        upper.push_back(high[i]);
      }
    }
    lower.insert(lower.end(), upper.rbegin(), upper.rend());
    areas.push_back(std::move(lower));
  }
  return areas;
}

}  // namespace cartvo
