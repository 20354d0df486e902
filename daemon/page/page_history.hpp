#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "daemon/page/page_sample.hpp"

namespace cartvo::daemon {

/// The last minute of samples and the path since the start, both bounded: the path has at most
/// kMaxPathPoints, at distances that double when it is full. Not thread-safe.
class PageHistory {
 public:
  static constexpr std::int64_t kSpan_us = 60'000'000;
  static constexpr std::size_t kMaxSamples = 2048;
  static constexpr std::size_t kMaxPathPoints = 2000;

  void add(const PageSample& sample);

  bool empty() const { return samples_.empty(); }
  const PageSample& newest() const { return samples_.back(); }
  std::size_t size() const { return samples_.size(); }
  std::size_t pathSize() const { return path_.size(); }

  /// The newest samples as a JSON array, at most `count`.
  std::string newestJson(std::size_t count) const;

  /// {"samples": [...], "path": [...]}: all samples, and those that are points of the path.
  std::string json() const;

 private:
  void addToPath(const PageSample& sample);

  std::deque<PageSample> samples_;
  std::vector<PageSample> path_;
  double spacing_ = 0.1;  ///< m, between points of the path
};

}  // namespace cartvo::daemon
