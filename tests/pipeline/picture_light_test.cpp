// Light and texture of rendered and made-up pictures.
#include "pipeline/picture_light.hpp"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "vo_core/odometry_reason.hpp"

namespace cartvo::pipeline {
namespace {

constexpr int kWidth = 320, kHeight = 240;

/// Squares of 16 px of random grey values around a mean, with the noise of a sensor.
cv::Mat scene(double mean, double contrast) {
  cv::Mat squares(kHeight / 16, kWidth / 16, CV_32F), picture, noise(kHeight, kWidth, CV_32F);
  cv::RNG random(7);
  random.fill(squares, cv::RNG::UNIFORM, mean - contrast, mean + contrast);
  random.fill(noise, cv::RNG::NORMAL, 0.0, 2.0);
  cv::resize(squares, picture, noise.size(), 0.0, 0.0, cv::INTER_NEAREST);
  picture += noise;
  picture.convertTo(picture, CV_8U);
  return picture;
}

LightFault faultOf(const cv::Mat& picture, const cv::Mat& used = {}) {
  return lightFault(measureLight(picture, used));
}

TEST(PictureLight, FindsNoFaultByDay) {
  EXPECT_EQ(faultOf(scene(120.0, 60.0)), LightFault::none);
}

TEST(PictureLight, IsDarkAtDuskAndBehindABlackCover) {
  EXPECT_EQ(faultOf(0.07 * scene(120.0, 60.0)), LightFault::dark);
  EXPECT_EQ(faultOf(scene(16.0, 0.0)), LightFault::dark);
}

TEST(PictureLight, IsBlankBehindAFingerOrFogWhateverTheNoise) {
  cv::Mat shaded = scene(110.0, 0.0);
  for (int column = 0; column < kWidth; ++column)
    shaded.col(column) += column / 4;  // the shade of a finger is smooth
  EXPECT_EQ(faultOf(shaded), LightFault::blank);
  EXPECT_TRUE(lacksTexture(measureLight(shaded, {})));
}

TEST(PictureLight, IsTooBrightInGlare) {
  EXPECT_EQ(faultOf(2.0 * scene(120.0, 60.0)), LightFault::bright);
}

TEST(PictureLight, IgnoresWhatTheMaskCovers) {
  cv::Mat picture = scene(120.0, 0.0), used = cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(255));
  const cv::Rect bonnet(0, kHeight / 2, kWidth, kHeight / 2);
  scene(120.0, 60.0)(bonnet).copyTo(picture(bonnet));
  used(bonnet).setTo(0);
  EXPECT_EQ(faultOf(picture), LightFault::none);
  EXPECT_EQ(faultOf(picture, used), LightFault::blank);
}

TEST(PictureLight, ExplainsOnlyReasonsThatPicturesGive) {
  const auto bits = [](vo::OdometryReason reason) { return static_cast<std::uint32_t>(reason); };
  const PictureLight night{20.0, 0.3, 0.01, 0.1}, covered{8.0, 0.9, 0.0, 0.0};
  for (const vo::OdometryReason reason :
       {vo::OdometryReason::too_few_features, vo::OdometryReason::too_few_matches, vo::OdometryReason::bound})
    EXPECT_TRUE(mayExplain(night, bits(reason))) << bits(reason);
  for (const vo::OdometryReason reason :
       {vo::OdometryReason::offset_uncertain, vo::OdometryReason::time_step, vo::OdometryReason::first_pair})
    EXPECT_FALSE(mayExplain(covered, bits(reason))) << bits(reason);
  // Lamps show enough to compare left and right.
  EXPECT_FALSE(mayExplain(night, bits(vo::OdometryReason::wrong_stereo_geometry)));
  EXPECT_TRUE(mayExplain(covered, bits(vo::OdometryReason::wrong_stereo_geometry)));
  EXPECT_FALSE(mayExplain({}, bits(vo::OdometryReason::too_few_matches)));
}

}  // namespace
}  // namespace cartvo::pipeline
