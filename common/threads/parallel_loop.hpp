#pragma once

#include <algorithm>
#include <cstddef>

#include <opencv2/core/utility.hpp>

namespace cartvo {

/// Calls work(i) for each i below `count` on OpenCV's threads; each call must write only to its own data.
template <typename Work>
void forEachIndex(std::size_t count, const Work& work) {
  cv::parallel_for_(cv::Range(0, static_cast<int>(count)), [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i)
      work(static_cast<std::size_t>(i));
  });
}

/// Calls both functions, concurrently if threads are available.
template <typename First, typename Second>
void doBoth(const First& first, const Second& second) {
  forEachIndex(2, [&](std::size_t i) {
    if (i == 0)
      first();
    else
      second();
  });
}

/// Calls work(first, size) for consecutive blocks of at most `block` out of `count` indices, in parallel.
template <typename Work>
void forEachBlock(std::size_t count, std::size_t block, const Work& work) {
  forEachIndex((count + block - 1) / block, [&](std::size_t i) {
    const std::size_t first = i * block;
    work(first, std::min(block, count - first));
  });
}

}  // namespace cartvo
