// Tests of telling the same picture with other noise from another one.
#include "vo_core/integrity/picture_stillness.hpp"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace cartvo::vo {
namespace {

constexpr int kWidth = 340, kHeight = 210;

/// A part of a random scene, `shift` px farther to the right, with noise.
class PictureStillnessOf : public testing::Test {
 protected:
  PictureStillnessOf() {
    cv::Mat noise(300, 500, CV_8UC1);
    random_.fill(noise, cv::RNG::UNIFORM, 0, 256);
    cv::GaussianBlur(noise, scene_, {}, 2.0);
    scene_.convertTo(scene_, -1, 4.0, -384.0);
  }
  cv::Mat view(int shift, double brighter = 0.0, double noise = 3.0) {
    cv::Mat image;
    scene_(cv::Rect(shift, 0, kWidth, kHeight)).convertTo(image, CV_16S, 0.8, 20.0 + brighter);
    cv::Mat added(image.size(), CV_16S);
    random_.fill(added, cv::RNG::NORMAL, 0.0, noise);
    image += added;
    image.convertTo(image, CV_8U);
    return image;
  }
  void update(const cv::Mat& left, const cv::Mat& right) { stillness_.update({left, right}, masks_); }

  cv::RNG random_{1};
  cv::Mat scene_;
  StereoMasks masks_;
  PictureStillness stillness_;
};

TEST_F(PictureStillnessOf, NamesTheCameraThatRepeats) {
  for (int i = 0; i < 5; ++i)
    update(view(3 * i), view(3 * i));
  EXPECT_FALSE(stillness_.leftAlone() || stillness_.rightAlone());
  update(view(15), view(12));
  EXPECT_FALSE(stillness_.rightAlone()) << "one comparison may be a sudden stop";
  for (int i = 6; i < 9; ++i) {
    update(view(3 * i), view(12, 4.0 * i));
    EXPECT_TRUE(stillness_.rightAlone()) << i;
    EXPECT_FALSE(stillness_.leftAlone());
  }
  update(view(27), view(27));
  EXPECT_FALSE(stillness_.rightAlone());
  update(view(27), view(30));
  update(view(27), view(33));
  EXPECT_TRUE(stillness_.leftAlone());
}

TEST_F(PictureStillnessOf, SumsSlowMotionUp) {
  for (int i = 0; i < 12; ++i)
    update(view(0), view(i / 2));
  EXPECT_TRUE(stillness_.leftAlone());
}

TEST_F(PictureStillnessOf, TakesAStandstillForOne) {
  for (int i = 0; i < 30; ++i) {
    update(view(0), view(0));
    EXPECT_FALSE(stillness_.leftAlone() || stillness_.rightAlone()) << i;
  }
}

/// The camera that repeats recovers only when the cart drives on: the standing cart is not kept INVALID.
TEST_F(PictureStillnessOf, EndsWhereTheCartStands) {
  update(view(0), view(0));
  update(view(3), view(0));
  update(view(6), view(0));
  EXPECT_TRUE(stillness_.rightAlone());
  for (int i = 0; i < 10; ++i)
    update(view(6), view(0));
  EXPECT_FALSE(stillness_.rightAlone());
}

TEST_F(PictureStillnessOf, SaysNothingOfDarkOrMaskedPictures) {
  const cv::Mat dark(kHeight, kWidth, CV_8UC1, cv::Scalar(3));
  for (int i = 0; i < 4; ++i) {
    update(view(3 * i), dark);
    EXPECT_FALSE(stillness_.rightAlone()) << i;
  }
  masks_.right = cv::Mat::zeros(kHeight, kWidth, CV_8UC1);
  for (int i = 0; i < 4; ++i) {
    update(view(3 * i), view(0));
    EXPECT_FALSE(stillness_.rightAlone()) << i;
  }
}

TEST_F(PictureStillnessOf, LooksPastHotPixels) {
  const auto withHotPixels = [](cv::Mat image) {
    cv::RNG places(7);
    for (int i = 0; i < kWidth * kHeight / 200; ++i)
      image.at<std::uint8_t>(places.uniform(0, kHeight), places.uniform(0, kWidth)) = 255;
    return image;
  };
  for (int i = 0; i < 5; ++i) {
    update(view(3 * i), withHotPixels(view(3 * i)));
    EXPECT_FALSE(stillness_.leftAlone() || stillness_.rightAlone()) << i;
  }
}

}  // namespace
}  // namespace cartvo::vo
