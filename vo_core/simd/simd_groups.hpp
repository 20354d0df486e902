#pragma once

#include <algorithm>
#include <cstddef>

#include "vo_core/simd/counting_sort.hpp"
#include "vo_core/simd/double_lanes.hpp"

namespace cartvo::vo {

/// Items sorted by their anchor frame, so that the SIMD lanes of a block share one anchor.
class SimdGroups {
 public:
  void reserve(std::size_t count) { by_anchor_.reserve(count); }

  /// Sorts `count` items by anchor_of(i), which is less than `anchors`. Items of one anchor keep their order.
  template <typename AnchorOf>
  void sort(std::size_t anchors, std::size_t count, const AnchorOf& anchor_of) {
    by_anchor_.sort(anchors, count, anchor_of);
  }

  /// Maximum number of blocks of as many items as memory is reserved for.
  std::size_t maximumBlocks() const { return by_anchor_.capacity() / kDoubleLanes + by_anchor_.groups() + 1; }

  /// Calls use(anchor, indices, count) for blocks of at most kDoubleLanes items.
  template <typename Use>
  void forEachBlock(const Use& use) const {
    for (std::size_t anchor = 0; anchor < by_anchor_.groups(); ++anchor) {
      const int end = by_anchor_.begin(anchor + 1);
      for (int at = by_anchor_.begin(anchor); at < end; at += kDoubleLanes)
        use(static_cast<int>(anchor), &by_anchor_[at], std::min(end - at, kDoubleLanes));
    }
  }

 private:
  CountingSort by_anchor_;
};

}  // namespace cartvo::vo
