#pragma once

#include <algorithm>
#include <vector>

namespace cartvo::benchmark {

/// The results in groups, in the order of their first members. `same(a, b)`: whether two results belong to
/// the same group.
template <typename Result, typename Same>
std::vector<std::vector<Result>> grouped(const std::vector<Result>& results, const Same& same) {
  std::vector<std::vector<Result>> groups;
  for (const Result& one : results) {
    const auto group = std::find_if(groups.begin(), groups.end(), [&](const std::vector<Result>& candidate) {
      return same(candidate.front(), one);
    });
    if (group == groups.end()) {
      groups.push_back({one});
    } else {
      group->push_back(one);
    }
  }
  return groups;
}

}  // namespace cartvo::benchmark
