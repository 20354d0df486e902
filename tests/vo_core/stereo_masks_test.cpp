// Tests of masks for parts of the images that never show the scene.
#include "vo_core/stereo_masks.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/error_message.hpp"
#include "support/vo_core/corridor_world.hpp"
#include "support/vo_core/still_overlay.hpp"
#include "vo_core/stereo_odometry.hpp"
#include "vo_core/tracking/landmark_tracker.hpp"

namespace cartvo::vo {
namespace {

using ::testing::HasSubstr;

const StereoCamera kCamera{260.0, 208.0, 112.0, 0.2, 416, 224};
constexpr std::int64_t kPeriod = 50'000'000;  // ns
constexpr double kStep = 0.1;                 // m per pair
constexpr int kPairs = 8;
const cv::Rect kPillar(60, 0, 120, 224);  // as wide as a cart's own post close to the camera
constexpr int kDisparity = 50;            // px

cv::Mat maskOf(const cv::Rect& unused) {
  cv::Mat mask(kCamera.height, kCamera.width, CV_8UC1, cv::Scalar(255));
  mask(unused).setTo(0);
  return mask;
}

StereoMasks pillarMasks() {
  return {maskOf(kPillar), maskOf(kPillar - cv::Point(kDisparity, 0))};
}

OdometrySettings settingsWith(Estimator estimator) {
  OdometrySettings settings;
  settings.estimator = estimator;
  settings.features = 400;
  settings.rig_refinement = RigRefinement::off;
  return settings;
}

struct Drive {
  bool all_valid = true;
  double largest_error = 0.0;  ///< m, of a motion
};

/// A straight drive along the corridor.
Drive driven(bool with_pillar, const StereoMasks& masks, Estimator estimator = Estimator::reprojection) {
  static const test::CorridorWorld world(1);
  StereoOdometry odometry(kCamera, settingsWith(estimator), {}, masks);
  NullStageObserver observer;
  Drive drive;
  for (int i = 0; i < kPairs; ++i) {
    const Eigen::Isometry3d pose(Eigen::Translation3d(0.0, 0.0, kStep * i));
    StereoImages images = world.render(kCamera, pose, i * kPeriod);
    if (with_pillar) test::drawStillOverlay(images, kPillar, kDisparity);
    const OdometryEstimate estimate = odometry.process(images, observer);
    if (i == 0) continue;
    drive.all_valid = drive.all_valid && estimate.valid;
    const Eigen::Vector3d error =
        estimate.T_previous_current.translation() - Eigen::Vector3d(0.0, 0.0, kStep);
    drive.largest_error = std::max(drive.largest_error, error.norm());
  }
  return drive;
}

TEST(StereoMasks, MakeAViewWithAPillarAsGoodAsOneWithout) {
  const Drive without = driven(false, pillarMasks());
  const Drive with = driven(true, pillarMasks());
  EXPECT_TRUE(with.all_valid);
  EXPECT_LT(with.largest_error, 0.02 * kStep);
  // Not a pixel of the pillar says anything.
  EXPECT_NEAR(with.largest_error, without.largest_error, 1e-3 * kStep);
}

TEST(StereoMasks, HoldForTheEstimatorOfTheThesis) {
  const Drive with = driven(true, pillarMasks(), Estimator::thesis);
  EXPECT_TRUE(with.all_valid);
  EXPECT_LT(with.largest_error, 0.05 * kStep);
}

TEST(StereoMasks, OfOtherSizesOrTypesAreRefused) {
  const auto refusal = [](const StereoMasks& masks) {
    return test::messageOf([&] { StereoOdometry(kCamera, {}, {}, masks); });
  };
  EXPECT_THAT(refusal({cv::Mat(10, 20, CV_8UC1), {}}), HasSubstr("left mask is 20x10 of OpenCV type 0"));
  EXPECT_THAT(refusal({{}, cv::Mat(kCamera.height, kCamera.width, CV_32FC1)}), HasSubstr("right mask is"));
}

/// Tracks landmarks over images whose left half is masked from the second one on.
class MaskedTrackerTest : public testing::Test {
 protected:
  static constexpr int kMiddle = 208;  // px
  const test::CorridorWorld world_{2};
  const ImageMask left_half_{maskOf({0, 0, kMiddle, kCamera.height})};
  LandmarkTracker tracker_{kCamera, settingsWith(Estimator::reprojection)};
  std::vector<Landmark> landmarks_;

  WindowFrame frameAt(int index, const ImageMask& mask) const {
    WindowFrame frame;
    frame.index = index;
    frame.T_world_camera.translation().z() = kStep * index;
    frame.left = PyramidPool(4, mask).build(world_.view(kCamera, frame.T_world_camera));
    return frame;
  }
  SharedPyramid rightOf(const WindowFrame& frame, const ImageMask& mask) const {
    return PyramidPool(kLandmarkLevels, mask).build(world_.rightView(kCamera, frame.T_world_camera));
  }
};

TEST_F(MaskedTrackerTest, CreatesNoLandmarkThere) {
  const WindowFrame frame = frameAt(0, left_half_);
  tracker_.replenish(landmarks_, *frame.left, 0);
  EXPECT_GT(landmarks_.size(), 50U);
  for (const Landmark& landmark : landmarks_)
    EXPECT_TRUE(left_half_.allows(landmark.last().left, landmark.level)) << landmark.last().left.transpose();
}

TEST_F(MaskedTrackerTest, LosesLandmarksThatComeToLieThere) {
  const std::vector<WindowFrame> window{frameAt(0, {})};
  tracker_.replenish(landmarks_, *window.front().left, 0);
  const std::vector<Landmark> before = landmarks_;
  const WindowFrame next = frameAt(1, left_half_);
  tracker_.track(before, landmarks_, {window, *next.left, 1, 0, std::nullopt});
  EXPECT_GT(landmarks_.size(), 50U);
  for (const Landmark& landmark : landmarks_)
    EXPECT_TRUE(left_half_.allows(landmark.last().left, landmark.level)) << landmark.last().left.transpose();
}

TEST_F(MaskedTrackerTest, RejectsMatchesThereInTheRightImage) {
  const std::vector<WindowFrame> window{frameAt(0, {})};
  tracker_.replenish(landmarks_, *window.front().left, 0);
  const SharedPyramid right = rightOf(window.front(), left_half_);
  Eigen::Isometry3d T_right_left = Eigen::Isometry3d::Identity();
  T_right_left.translation().x() = -kCamera.baseline;
  tracker_.matchStereo(landmarks_, window, *window.front().left, *right,
                       RowTransform(kCamera, RowTiming(kCamera, {}), window.front(), T_right_left),
                       window.front().T_world_camera);
  EXPECT_GT(countStereo(landmarks_), 30);
  for (const Landmark& landmark : landmarks_) {
    if (!landmark.last().stereo) continue;
    EXPECT_TRUE(left_half_.allows(landmark.last().right(), landmark.level));
  }
}

}  // namespace
}  // namespace cartvo::vo
