#pragma once

#include <cstddef>

#include <opencv2/core/utility.hpp>

namespace cartvo {

/// Calls work(i) for each i below count, on OpenCV's threads; each i must write to its own place only.
template <typename Work>
void forEachIndex(std::size_t count, const Work& work) {
  cv::parallel_for_(cv::Range(0, static_cast<int>(count)), [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i)
      work(static_cast<std::size_t>(i));
  });
}

}  // namespace cartvo
