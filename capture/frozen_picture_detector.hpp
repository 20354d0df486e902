#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include <opencv2/core/mat.hpp>

namespace cartvo::capture {

/// Detects a frozen camera: one that keeps sending, but always the same picture. Sensor noise makes the
/// pictures of a standing cart differ, so only a frozen camera repeats every bit. A uniform picture, as that
/// of a covered lens, is no evidence: encoders give it without noise.
class FrozenPictureDetector {
 public:
  using Clock = std::chrono::steady_clock;

  /// Adds the next picture, CV_8UC1. Returns for how long the picture has been the same.
  Clock::duration update(const cv::Mat& image, Clock::time_point now);

 private:
  std::optional<std::uint64_t> hash_;
  Clock::time_point since_;
};

}  // namespace cartvo::capture
