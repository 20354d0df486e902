#pragma once

#include <cstddef>
#include <vector>

namespace cartvo::vo {

/// Counting sort: indices of items sorted by group. Reuses its memory.
class CountingSort {
 public:
  /// Reserves memory for `count` items, so that a growing number of them does not allocate at each new
  /// maximum.
  void reserve(std::size_t count) { order_.reserve(count); }
  std::size_t capacity() const { return order_.capacity(); }

  /// Sorts `count` items by group_of(i), which is less than `groups`. Items of one group keep their order.
  template <typename GroupOf>
  void sort(std::size_t groups, std::size_t count, const GroupOf& group_of) {
    begin_.assign(groups + 1, 0);
    order_.resize(count);
    for (std::size_t i = 0; i < count; ++i)
      ++begin_[group_of(i) + 1];
    for (std::size_t group = 0; group < groups; ++group)
      begin_[group + 1] += begin_[group];
    next_ = begin_;
    for (std::size_t i = 0; i < count; ++i)
      order_[next_[group_of(i)]++] = static_cast<int>(i);
  }

  std::size_t groups() const { return begin_.empty() ? 0 : begin_.size() - 1; }
  /// Position of the first item of a group; begin(groups()) is the number of items.
  int begin(std::size_t group) const { return begin_[group]; }
  /// Index of the item at a position. The items of a group are adjacent.
  const int& operator[](int place) const { return order_[place]; }

 private:
  std::vector<int> begin_;  // first position of each group, and the end
  std::vector<int> order_;
  std::vector<int> next_;  // next free position of each group while sorting
};

}  // namespace cartvo::vo
