#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace cartvo {

/// Calls visit(length, first, last) for the segments of each length that start at each step-th pose: up to
/// the first pose farther along the path than the length, as in KITTI's devkit. `distances`: of each pose
/// from the path's start, m.
template <typename Visit>
void forEachSegment(const std::vector<double>& distances, std::span<const double> lengths, std::size_t step,
                    const Visit& visit) {
  for (const double length : lengths) {
    for (std::size_t first = 0; first < distances.size(); first += step) {
      const auto last =
          std::upper_bound(distances.begin() + first, distances.end(), distances[first] + length);
      if (last == distances.end()) break;
      visit(length, first, static_cast<std::size_t>(last - distances.begin()));
    }
  }
}

}  // namespace cartvo
