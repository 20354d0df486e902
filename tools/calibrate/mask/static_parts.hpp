#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

// Finds the parts of a camera's raw pictures that keep their place while the cart drives: the roof edge, a
// pillar, the bonnet, lettering, dirt on the lens.

namespace cartvo::calibrate {

constexpr std::size_t kMinPictures = 30;  ///< that a result needs
constexpr double kMaxStaticShare = 0.5;   ///< of the picture, and of what has texture in it

/// Static parts of a picture.
struct StaticParts {
  cv::Mat used;                 ///< CV_8UC1: 0 in static parts, 255 elsewhere
  double share = 0.0;           ///< of the picture that is static
  std::vector<cv::Rect> boxes;  ///< that enclose the parts, px, largest first
  std::size_t pictures = 0;     ///< that were compared
};

/// Collects the edges of pictures of one camera. An edge is static if it is at the same pixel, with the same
/// direction, in most of the pictures that differ from each other. Parts without texture, such as the sky,
/// are never static: nothing can be tracked there.
class StaticPartFinder {
 public:
  /// Adds a picture (CV_8UC1, all of one size) taken `time_ns` after any epoch. Skips pictures that follow
  /// the last one at once, and those in which too little has changed since, as at a standstill.
  void add(const cv::Mat& picture, std::int64_t time_ns);

  std::size_t pictures() const { return pictures_; }  ///< that are not skipped

  /// Throws std::runtime_error with what to do if fewer than kMinPictures differ from each other, or more
  /// than kMaxStaticShare is static.
  StaticParts result() const;

 private:
  cv::Mat last_;            ///< edges of the last picture that was not skipped; CV_32FC2
  cv::Mat sum_, size_sum_;  ///< of the edges, CV_32FC2; of their lengths, CV_32FC1
  std::int64_t last_time_ns_ = 0;
  std::size_t pictures_ = 0;
};

}  // namespace cartvo::calibrate
