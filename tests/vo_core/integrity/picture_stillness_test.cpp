// Tests of telling the same picture with other noise from another one.
#include "vo_core/integrity/picture_stillness.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "support/vo_core/synthetic_texture.hpp"
#include "vo_core/integrity/standstill.hpp"
#include "vo_core/rigid_motion.hpp"

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

constexpr std::int64_t kPeriod = 55'000'000;  // ns
const StandstillSettings kSettings{.translation = 0.0015, .rotation = 0.0002, .least_time = 0.25};

Eigen::Isometry3d poseOf(double z, double yaw) {
  Vector6d vector = Vector6d::Zero();
  vector[2] = z;
  vector[4] = yaw;
  return motionFromVector(vector);
}

/// Standstill of 40 pairs, whose poses are a function of the time in seconds.
template <typename Pose>
std::vector<bool> standing(const Pose& pose) {
  StandstillDetector detector(kSettings);
  std::vector<bool> stands;
  for (int i = 0; i < 40; ++i)
    stands.push_back(detector.update(pose(1e-9 * static_cast<double>(i * kPeriod)), i * kPeriod));
  return stands;
}

int count(const std::vector<bool>& stands) {
  return static_cast<int>(std::count(stands.begin(), stands.end(), true));
}

TEST(StandstillDetector, DetectsAStandstillAfterTheMinimumTime) {
  const auto stands = standing([](double) { return poseOf(7.0, 1.0); });
  for (int i = 0; i < 40; ++i)
    EXPECT_EQ(stands[i], i >= 5) << i;  // 5 * 55 ms is the first multiple beyond 0.25 s
}

TEST(StandstillDetector, ToleratesNoiseOfThePose) {
  test::Noise noise(1);
  const auto stands =
      standing([&](double) { return poseOf(2e-4 * noise.gaussian(), 2e-5 * noise.gaussian()); });
  EXPECT_EQ(count(stands), 35);
}

TEST(StandstillDetector, RejectsASlowDrive) {
  EXPECT_EQ(count(standing([](double t) { return poseOf(0.03 * t, 0.0); })), 0);
}

TEST(StandstillDetector, RejectsATurnOnTheSpot) {
  EXPECT_EQ(count(standing([](double t) { return poseOf(0.0, -0.004 * t); })), 0);
}

TEST(StandstillDetector, EndsWithTheFirstMotion) {
  const auto stands = standing([](double t) { return poseOf(t < 1.0 ? 0.0 : 0.1 * (t - 1.0), 0.0); });
  EXPECT_TRUE(stands[18]);   // 0.99 s
  EXPECT_FALSE(stands[19]);  // after 4.5 mm
  EXPECT_FALSE(stands[39]);
}

TEST(StandstillDetector, RestartsTheMinimumTimeAfterAMove) {
  const auto stands = standing([](double t) { return poseOf(t < 1.0 ? 0.0 : 0.5, 0.0); });
  EXPECT_TRUE(stands[18]);
  for (int i = 19; i < 24; ++i)
    EXPECT_FALSE(stands[i]) << i;
  EXPECT_TRUE(stands[24]);
}

TEST(StandstillDetector, MotionExceedsLimitsByTranslationOrRotation) {
  const StandstillDetector detector(kSettings);
  EXPECT_FALSE(detector.exceedsLimits(Eigen::Isometry3d::Identity()));
  EXPECT_FALSE(detector.exceedsLimits(poseOf(0.0014, 0.00019)));
  EXPECT_TRUE(detector.exceedsLimits(poseOf(-0.0016, 0.0)));
  EXPECT_TRUE(detector.exceedsLimits(poseOf(0.0, -0.00021)));
}

}  // namespace

}  // namespace cartvo::vo
