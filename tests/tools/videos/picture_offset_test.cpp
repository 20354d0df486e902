// Tests of the time offset from image motion, on synthetic motions of two cameras.
#include "tools/videos/picture_offset.hpp"

#include <cmath>
#include <functional>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "support/error_message.hpp"

namespace cartvo {
namespace {

using testing::HasSubstr;

/// Image motion of a drive with occasional turns and continuous bumps, in image widths.
class Drive {
 public:
  explicit Drive(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (int i = 0; i < 60; ++i)
      turns_.push_back({300.0 * unit(random), 2.0 + 3.0 * unit(random), unit(random) - 0.5});
    for (int i = 0; i < 25; ++i)
      bumps_.push_back({0.5 + 5.0 * unit(random), 6.28 * unit(random), 4e-3 * unit(random)});
  }

  cv::Point2d at(double time) const {
    double x = 0.0;
    for (const Turn& turn : turns_)
      x += turn.angle / (1.0 + std::exp(-(time - turn.time) / (0.25 * turn.length)));
    double y = 0.0;
    for (const Bump& bump : bumps_)
      y += bump.height * std::sin(6.28 * bump.frequency * time + bump.phase);
    return {x, y};
  }

 private:
  struct Turn {
    double time, length, angle;
  };
  struct Bump {
    double frequency, phase, height;
  };
  std::vector<Turn> turns_;
  std::vector<Bump> bumps_;
};

struct Camera {
  double begin = 0.0;  ///< s, start in the drive's time
  double duration = 60.0;
  double frame_rate = 25.0;
  double shift = 0.0;  ///< s, drive's time minus file time
  double skew = 0.0;   ///< drive's time = shift + (1 + skew) * file time
  double scale = 1.0;
  double noise = 2e-4;
};

ImageMotion filmed(const std::function<cv::Point2d(double)>& path, const Camera& camera, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, camera.noise);
  ImageMotion motion;
  cv::Point2d drift(0.0, 0.0);
  for (double time = camera.begin; time < camera.begin + camera.duration; time += 1.0 / camera.frame_rate) {
    drift += cv::Point2d(noise(random), noise(random));  // independent error of each step
    motion.times.push_back((time - camera.shift) / (1.0 + camera.skew));
    motion.positions.push_back(camera.scale * path(time) + drift);
  }
  return motion;
}

TEST(PictureOffset, IsAccurateFarBelowAFramePeriod) {
  const Drive drive(1);
  const auto path = [&](double time) { return drive.at(time); };
  for (const double shift : {0.0, 0.0131, -0.4567, 7.3021, -12.5}) {
    const ImageMotion left = filmed(path, {.begin = 20.0, .frame_rate = 25.0}, 1);
    const ImageMotion right =
        filmed(path, {.begin = 22.013, .frame_rate = 24.0, .shift = shift, .scale = 0.9}, 2);
    const PictureOffset found = findPictureOffset(left, right);
    EXPECT_NEAR(found.offset, shift, 2e-3) << shift;
    EXPECT_NEAR(found.offset, shift, 3.0 * found.stddev) << shift;
    EXPECT_LT(found.stddev, 3e-3);
    EXPECT_GT(found.agreement, 0.8);
  }
}

TEST(PictureOffset, IsFoundForShortVideosWithACommonStartOrEnd) {
  const Drive drive(1);
  const auto path = [&](double time) { return drive.at(time); };
  const ImageMotion left = filmed(path, {.begin = 20.0, .duration = 20.0, .frame_rate = 18.0}, 1);
  for (const double begin : {20.0, 21.4}) {
    const ImageMotion right =
        filmed(path, {.begin = begin, .duration = 40.0 - begin, .frame_rate = 18.0, .shift = begin}, 2);
    EXPECT_NEAR(findPictureOffset(left, right).offset, begin, 2e-3);
  }
}

TEST(PictureOffset, EstimatesClockSkew) {
  const Drive drive(2);
  const auto path = [&](double time) { return drive.at(time); };
  const ImageMotion left = filmed(path, {.duration = 300.0}, 1);
  const ImageMotion right = filmed(path, {.duration = 300.0, .shift = 1.0, .skew = 80e-6}, 2);
  const PictureOffset found = findPictureOffset(left, right);
  ASSERT_TRUE(found.skew);
  EXPECT_NEAR(*found.skew, 80e-6, 20e-6);
  for (const double time : {0.0, 150.0, 300.0})
    EXPECT_NEAR(found.offset + *found.skew * time, 1.0 + 80e-6 * time, 3.0 * found.stddev);
}

TEST(PictureOffset, IsRejectedAtStandstill) {
  const auto still = [](double) { return cv::Point2d(0.0, 0.0); };
  EXPECT_THAT(test::messageOf([&] { findPictureOffset(filmed(still, {}, 1), filmed(still, {}, 2)); }),
              HasSubstr("give --offset-ms"));
}

TEST(PictureOffset, IsRejectedForPeriodicMotion) {
  const auto swinging = [](double time) { return cv::Point2d(0.1 * std::sin(0.9 * time), 0.0); };
  EXPECT_THAT(test::messageOf([&] { findPictureOffset(filmed(swinging, {}, 1), filmed(swinging, {}, 2)); }),
              HasSubstr("agree as well"));
}

TEST(PictureOffset, IsRejectedForDifferentDrives) {
  const Drive one(3), other(4);
  const ImageMotion left = filmed([&](double time) { return one.at(time); }, {}, 1);
  const ImageMotion right = filmed([&](double time) { return other.at(time); }, {.begin = 100.0}, 2);
  EXPECT_THAT(test::messageOf([&] { findPictureOffset(left, right); }),
              HasSubstr("cannot be found from their pictures"));
}

TEST(PictureOffset, IsRejectedForShortVideos) {
  const Drive drive(1);
  const ImageMotion motion = filmed([&](double time) { return drive.at(time); }, {.duration = 3.0}, 1);
  EXPECT_THAT(test::messageOf([&] { findPictureOffset(motion, motion); }), HasSubstr("too short"));
  EXPECT_THAT(test::messageOf([&] { findPictureOffset({}, motion); }),
              HasSubstr("the left video has 0 pictures; expected at least 10"));
}

TEST(ImageMotion, AccumulatesTheShiftOfTheImages) {
  cv::Mat scene(400, 1000, CV_8UC1);
  cv::RNG random(1);
  random.fill(scene, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(scene, scene, {0, 0}, 6.0);
  cv::normalize(scene, scene, 0, 255, cv::NORM_MINMAX);
  ImageMotionTracker tracker;
  for (int i = 0; i < 20; ++i)
    tracker.addImage(0.04 * i, scene(cv::Rect(200 - 5 * i, 60 + 2 * i, 640, 240)));
  tracker.addImage(0.1, scene(cv::Rect(0, 0, 640, 240)));  // not later than the last one: ignored
  ASSERT_EQ(tracker.motion().times.size(), 20U);
  const double width = 0.8 * 640.0;  // of the cropped image
  EXPECT_NEAR(tracker.motion().positions.back().x, 19 * 5 / width, 0.02 * 19 * 5 / width);
  EXPECT_NEAR(tracker.motion().positions.back().y, -19 * 2 / width, 0.05 * 19 * 2 / width);
}

}  // namespace
}  // namespace cartvo
