#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include <opencv2/core/mat.hpp>

namespace cartvo {

/// Notices a camera that sends on, but always the same picture. A sensor's noise makes even a parked cart's
/// pictures differ; only a camera that hangs repeats each bit.
class FrozenPicture {
 public:
  using Clock = std::chrono::steady_clock;

  /// The next picture, CV_8UC1. Returns how long the picture has been the same.
  Clock::duration add(const cv::Mat& image, Clock::time_point now);

 private:
  std::optional<std::uint64_t> digest_;
  Clock::time_point since_;
};

}  // namespace cartvo
