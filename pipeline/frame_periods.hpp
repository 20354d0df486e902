#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace cartvo::pipeline {

/// Frame periods of the left and the right camera, ns; 0 until they are known.
struct FramePeriods {
  std::array<std::int64_t, 2> by_exposures{};
  std::array<std::int64_t, 2> by_arrivals{};  ///< mean of some seconds, whatever the exposures are

  /// The period of the pairs: the slower camera's, by the slower of both measures, so that neither wrong time
  /// stamps nor frames that arrive at once shorten it. 0 if it is unknown.
  std::int64_t ofPairsNs() const {
    std::int64_t longest = 0;
    for (std::size_t i = 0; i < by_exposures.size(); ++i) {
      if (by_exposures[i] == 0) return 0;
      longest = std::max({longest, by_exposures[i], by_arrivals[i]});
    }
    return longest;
  }
};

}  // namespace cartvo::pipeline
