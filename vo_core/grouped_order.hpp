#pragma once

#include <cstddef>
#include <vector>

namespace cartvo {

/// Indices of things sorted by the group that each is in (a counting sort), in memory that is used again.
class GroupedOrder {
 public:
  /// Room for so many things: who sorts few and then more, should not have to seek memory for each record.
  void reserve(std::size_t count) { order_.reserve(count); }
  std::size_t capacity() const { return order_.capacity(); }

  /// `group_of(i)`: less than `groups`. Those of one group stay in their order.
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
  /// The place of a group's first thing; of groups(), how many things there are.
  int begin(std::size_t group) const { return begin_[group]; }
  /// The index of the thing at that place. Things of a group lie side by side.
  const int& operator[](int place) const { return order_[place]; }

 private:
  std::vector<int> begin_;  // of each group, and the end
  std::vector<int> order_;
  std::vector<int> next_;  // place of each group, while they are sorted
};

}  // namespace cartvo
