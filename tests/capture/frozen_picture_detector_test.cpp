// Pictures that repeat, of textured scenes and behind a covered lens.
#include "capture/frozen_picture_detector.hpp"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace cartvo::capture {
namespace {

using Clock = FrozenPictureDetector::Clock;
using std::chrono::seconds;

TEST(FrozenPictureDetector, CountsSinceTheFirstOfEqualPicturesWithTexture) {
  cv::Mat picture(64, 96, CV_8UC1);
  cv::RNG(1).fill(picture, cv::RNG::UNIFORM, 0, 255);
  FrozenPictureDetector detector;
  const Clock::time_point start{};
  EXPECT_EQ(detector.update(picture, start), seconds(0));
  EXPECT_EQ(detector.update(picture, start + seconds(6)), seconds(6));
  picture.at<unsigned char>(0, 0) ^= 1;
  EXPECT_EQ(detector.update(picture, start + seconds(7)), seconds(0));
}

TEST(FrozenPictureDetector, TakesUniformPicturesForThoseOfACoveredLens) {
  const cv::Mat covered(64, 96, CV_8UC1, cv::Scalar(16));
  FrozenPictureDetector detector;
  const Clock::time_point start{};
  detector.update(covered, start);
  EXPECT_EQ(detector.update(covered, start + seconds(60)), seconds(0));
}

}  // namespace
}  // namespace cartvo::capture
