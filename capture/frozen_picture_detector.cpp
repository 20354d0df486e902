// Detection of repeated pictures by a hash of their pixels.

#include "capture/frozen_picture_detector.hpp"

#include "common/picture_digest.hpp"

namespace cartvo::capture {

FrozenPictureDetector::Clock::duration FrozenPictureDetector::update(const cv::Mat& image,
                                                                     Clock::time_point now) {
  const std::uint64_t current = pictureDigest(image);
  if (hash_ != current || isUniform(image)) {
    hash_ = current;
    since_ = now;
  }
  return now - since_;
}

}  // namespace cartvo::capture
