#pragma once

#include <algorithm>
#include <cstddef>

#include "vo_core/double_lanes.hpp"
#include "vo_core/grouped_order.hpp"

namespace cartvo {

/// Things with a host each, sorted by it: lanes side by side share one.
class LaneOrder {
 public:
  void reserve(std::size_t count) { by_host_.reserve(count); }

  /// `host_of(i)`: less than `hosts`. Those of one host stay in their order.
  template <typename HostOf>
  void sort(std::size_t hosts, std::size_t count, const HostOf& host_of) {
    by_host_.sort(hosts, count, host_of);
  }

  /// Of as many things as there is room for.
  std::size_t mostBlocks() const { return by_host_.capacity() / kDoubleLanes + by_host_.groups() + 1; }

  /// `use(host, indices, count)` gets up to so many as there are lanes.
  template <typename Use>
  void forEachBlock(const Use& use) const {
    for (std::size_t host = 0; host < by_host_.groups(); ++host) {
      const int end = by_host_.begin(host + 1);
      for (int at = by_host_.begin(host); at < end; at += kDoubleLanes)
        use(static_cast<int>(host), &by_host_[at], std::min(end - at, kDoubleLanes));
    }
  }

 private:
  GroupedOrder by_host_;
};

}  // namespace cartvo
