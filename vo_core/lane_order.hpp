#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "vo_core/double_lanes.hpp"

namespace cartvo {

/// Things with a host each, sorted by it: lanes side by side share one.
class LaneOrder {
 public:
  /// Room for so many things: who sorts few and then more, should not have to seek memory for each record.
  void reserve(std::size_t count) { order_.reserve(count); }

  /// `host_of(i)`: less than `hosts`. Those of one host stay in their order.
  template <typename HostOf>
  void sort(std::size_t hosts, std::size_t count, const HostOf& host_of) {
    begin_.assign(hosts + 1, 0);
    order_.resize(count);
    for (std::size_t i = 0; i < count; ++i)
      ++begin_[host_of(i) + 1];
    for (std::size_t host = 0; host < hosts; ++host)
      begin_[host + 1] += begin_[host];
    next_ = begin_;
    for (std::size_t i = 0; i < count; ++i)
      order_[next_[host_of(i)]++] = static_cast<int>(i);
  }

  /// Of as many things as there is room for.
  std::size_t mostBlocks() const { return order_.capacity() / kDoubleLanes + begin_.size(); }

  /// `use(host, indices, count)` gets up to so many as there are lanes.
  template <typename Use>
  void forEachBlock(const Use& use) const {
    for (std::size_t host = 0; host + 1 < begin_.size(); ++host)
      for (int at = begin_[host]; at < begin_[host + 1]; at += kDoubleLanes)
        use(static_cast<int>(host), &order_[at], std::min(begin_[host + 1] - at, kDoubleLanes));
  }

 private:
  std::vector<int> begin_;  // of each host, and the end
  std::vector<int> order_;
  std::vector<int> next_;  // place of each host, while they are sorted
};

}  // namespace cartvo
