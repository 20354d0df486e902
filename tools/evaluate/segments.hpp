#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace cartvo {

/// Calls visit(first, last) for the segments of `length` m that start at each step-th pose and end at the
/// first pose farther along the path than the length, as in KITTI's devkit. `distances`: distance of each
/// pose along the path from its start, m.
template <typename Visit>
void forEachSegment(const std::vector<double>& distances, double length, std::size_t step,
                    const Visit& visit) {
  for (std::size_t first = 0; first < distances.size(); first += step) {
    const auto last = std::upper_bound(distances.begin() + first, distances.end(), distances[first] + length);
    if (last == distances.end()) break;
    visit(first, static_cast<std::size_t>(last - distances.begin()));
  }
}

}  // namespace cartvo
