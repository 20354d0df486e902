// Tests of the odometry with a frozen camera, which continues to send its last image.
#include <algorithm>
#include <map>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "support/vo_core/corridor_world.hpp"
#include "vo_core/stereo_odometry.hpp"

namespace cartvo::vo {
namespace {

const StereoCamera kCamera{260.0, 208.0, 112.0, 0.2, 416, 224};
constexpr std::int64_t kPeriod = 50'000'000;  // ns
constexpr int kFreezes = 5, kRecovers = 8;    // first frozen pair, first pair after it
constexpr int kPairs = 11;
constexpr double kFast = 0.15,
                 kSlow = 0.01;  // m per pair: 3 m/s, and a speed that allows a stop within a pair
constexpr double kFastSpeed = kFast * 1e9 / kPeriod;  // m/s

enum class Frozen { both, left, right };

/// Index of the pair whose image this pair shows.
int shown(int pair, bool frozen) {
  return frozen && pair >= kFreezes && pair < kRecovers ? kFreezes - 1 : pair;
}

StereoOdometry odometryBy(Estimator estimator, const StereoMasks& masks = {}) {
  OdometrySettings settings;
  settings.estimator = estimator;
  settings.features = 400;
  settings.rig_refinement = RigRefinement::off;
  return {kCamera, settings, {}, masks};
}

/// A mask that covers `part`; empty if `part` is.
cv::Mat maskOf(const cv::Rect& part) {
  if (part.empty()) return {};
  cv::Mat mask(kCamera.height, kCamera.width, CV_8UC1, cv::Scalar(255));
  mask(part).setTo(0);
  return mask;
}

/// Estimates of a straight drive with `step` m per pair. The cameras write a clock into `clock`, which is
/// masked.
std::vector<OdometryEstimate> driven(double step, Frozen frozen, Estimator estimator,
                                     const cv::Rect& clock = {}) {
  static const test::CorridorWorld world(1);
  StereoOdometry odometry = odometryBy(estimator, {maskOf(clock), maskOf(clock)});
  NullStageObserver observer;
  const auto with_clock = [&](cv::Mat image, int pair) {
    if (!clock.empty()) image(clock).setTo(20 * pair);
    return image;
  };
  const auto pose = [&](int pair) { return Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, step * pair)); };
  std::vector<OdometryEstimate> estimates;
  for (int i = 0; i < kPairs; ++i) {
    const StereoImages pair{with_clock(world.view(kCamera, pose(shown(i, frozen != Frozen::right))), i),
                            with_clock(world.rightView(kCamera, pose(shown(i, frozen != Frozen::left))), i),
                            i * kPeriod, i * kPeriod};
    estimates.push_back(odometry.process(pair, observer));
  }
  return estimates;
}

class FrozenCamera : public testing::TestWithParam<std::tuple<Estimator, Frozen>> {};

TEST_P(FrozenCamera, InvalidatesTheEstimatesOfAMovingCart) {
  const auto [estimator, frozen] = GetParam();
  const auto estimates = driven(kFast, frozen, estimator);
  for (int i = 1; i < kPairs; ++i) {
    const bool is_frozen = i >= kFreezes && i < kRecovers;
    if (i < kFreezes) {
      EXPECT_TRUE(estimates[i].valid) << i;
    }
    if (!is_frozen) continue;
    EXPECT_FALSE(estimates[i].valid) << i;
    EXPECT_EQ(estimates[i].reasons, OdometryReason::repeated_picture);
    EXPECT_TRUE(estimates[i].T_world_camera.isApprox(estimates[kFreezes - 1].T_world_camera)) << i;
  }
  EXPECT_TRUE(estimates.back().valid);
  EXPECT_NEAR(estimates.back().T_previous_current.translation().z(), kFast, 0.02 * kFast);
}

TEST_P(FrozenCamera, IsDetectedBesideAClockThatGoesOn) {
  const auto [estimator, frozen] = GetParam();
  const auto estimates = driven(kFast, frozen, estimator, {20, 10, 120, 24});
  for (int i = kFreezes; i < kRecovers; ++i)
    EXPECT_EQ(estimates[i].reasons, OdometryReason::repeated_picture) << i;
  EXPECT_TRUE(estimates.back().valid);
}

INSTANTIATE_TEST_SUITE_P(Odometry, FrozenCamera,
                         testing::Combine(testing::Values(Estimator::reprojection, Estimator::thesis),
                                          testing::Values(Frozen::both, Frozen::left, Frozen::right)));

TEST(FrozenCameraOdometry, PoseHasNoGapAfterTheCameraRecovers) {
  const auto estimates = driven(kFast, Frozen::both, Estimator::reprojection);
  EXPECT_TRUE(estimates[kRecovers].valid);
  EXPECT_EQ(estimates.back().reset_counter, 0);
  EXPECT_NEAR(estimates.back().T_world_camera.translation().z(), kFast * (kPairs - 1), 0.02 * kFast * kPairs);
}

TEST(FrozenCameraOdometry, DetectsAFrozenImageThatAnEncoderRefines) {
  constexpr int kRecoversLate = 15, kEnd = 18;
  const test::CorridorWorld world(1);
  test::Noise noise(1);
  StereoOdometry odometry = odometryBy(Estimator::reprojection);
  NullStageObserver observer;
  OdometryEstimate estimate;
  for (int i = 0; i < kEnd; ++i) {
    const bool frozen = i >= kFreezes && i < kRecoversLate;
    const Eigen::Translation3d place(0.0, 0.0, kFast * (frozen ? kFreezes - 1 : i));
    StereoImages pair = world.render(kCamera, Eigen::Isometry3d(place), i * kPeriod);
    for (cv::Mat* image : {&pair.left, &pair.right})
      for (std::uint8_t& grey : cv::Mat_<std::uint8_t>(*image))
        grey = cv::saturate_cast<std::uint8_t>(grey + noise.gaussian());
    estimate = odometry.process(pair, observer);
    if (frozen) {
      EXPECT_FALSE(estimate.valid) << i;
    }
    if (estimate.valid) {
      EXPECT_NEAR(estimate.T_previous_current.translation().z(), kFastSpeed * estimate.time_step,
                  0.03 * kFastSpeed * estimate.time_step)
          << i;
    }
    // The first one is invalid for another reason.
    if (frozen && i > kFreezes) {
      EXPECT_EQ(estimate.reasons, OdometryReason::repeated_picture) << i;
    }
  }
  EXPECT_TRUE(estimate.valid);
}

class FrozenWithNoise : public testing::TestWithParam<Frozen> {};

/// The picture is repeated, its noise and its brightness are not.
TEST_P(FrozenWithNoise, IsNamed) {
  constexpr double kDrives = 0.06;  // m per pair: 1.2 m/s
  constexpr int kRecoversLate = 17, kEnd = 22;
  const test::CorridorWorld world(1);
  test::Noise noise(1);
  StereoOdometry odometry = odometryBy(Estimator::reprojection);
  NullStageObserver observer;
  const auto view = [&](int pair, bool freezes) {
    const bool frozen = freezes && pair >= kFreezes && pair < kRecoversLate;
    return Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, kDrives * (frozen ? kFreezes - 1 : pair)));
  };
  for (int i = 0; i < kEnd; ++i) {
    StereoImages pair{world.view(kCamera, view(i, GetParam() == Frozen::left)).clone(),
                      world.rightView(kCamera, view(i, GetParam() == Frozen::right)).clone(), i * kPeriod,
                      i * kPeriod};
    for (cv::Mat* image : {&pair.left, &pair.right})
      for (std::uint8_t& grey : cv::Mat_<std::uint8_t>(*image))
        grey = cv::saturate_cast<std::uint8_t>(grey + i % 3 + 2.0 * noise.gaussian());
    const OdometryEstimate estimate = odometry.process(pair, observer);
    if (i >= kFreezes + 3 && i < kRecoversLate) {
      EXPECT_EQ(estimate.reasons, OdometryReason::repeated_picture) << i;
    }
    if (estimate.valid) {
      EXPECT_NEAR(estimate.T_previous_current.translation().z() / estimate.time_step, kDrives * 1e9 / kPeriod,
                  0.1)
          << i;
    }
    if ((i > 0 && i < kFreezes) || i >= kRecoversLate + 2) {
      EXPECT_TRUE(estimate.valid) << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Odometry, FrozenWithNoise, testing::Values(Frozen::left, Frozen::right));

/// A cart that stands for kStands pairs, then accelerates; show() processes a pair whose cameras show the
/// given places.
class FrozenAtStandstill : public testing::Test {
 protected:
  static constexpr int kStands = 10;
  static constexpr double kAccelerates = 1.5;  // m/s^2

  static double place(int pair) {
    const double since = 1e-9 * kPeriod * std::max(pair - kStands, 0);
    return 0.5 * kAccelerates * since * since;
  }
  OdometryEstimate show(double left, double right, std::int64_t late_ns = 0) {
    const std::int64_t time = kPeriod * pair_++;
    StereoImages images{view(left).left.clone(), view(right).right.clone(), time, time + late_ns};
    for (cv::Mat* image : {&images.left, &images.right})
      for (std::uint8_t& grey : cv::Mat_<std::uint8_t>(*image))
        grey = cv::saturate_cast<std::uint8_t>(grey + noise_.gaussian());
    return odometry_.process(images, observer_);
  }
  int pair() const { return pair_; }
  void begin(Estimator estimator = Estimator::reprojection) {
    odometry_ = odometryBy(estimator);
    pair_ = 0;
  }

 private:
  /// Rendered once.
  const StereoImages& view(double place) {
    const Eigen::Isometry3d pose(Eigen::Translation3d(0.0, 0.0, place));
    if (const auto known = views_.find(place); known != views_.end()) return known->second;
    return views_[place] = world_.render(kCamera, pose, 0);
  }

  test::CorridorWorld world_{1};
  std::map<double, StereoImages> views_;
  test::Noise noise_{1};
  StereoOdometry odometry_ = odometryBy(Estimator::reprojection);
  NullStageObserver observer_;
  int pair_ = 0;
};

/// The left camera repeats its last image with different noise.
TEST_F(FrozenAtStandstill, IsDetectedByTheRightCamera) {
  constexpr int kRecoversLate = 45;    // later than the longest time between pairs of an epoch
  constexpr double kUnnoticed = 0.02;  // m
  while (pair() < kStands)
    show(0.0, 0.0);
  while (pair() < kRecoversLate) {
    const double right = place(pair());
    const OdometryEstimate estimate = show(0.0, right);
    EXPECT_EQ(estimate.valid, estimate.reasons == OdometryReason::zero_velocity) << pair();
    if (right > kUnnoticed) {
      EXPECT_EQ(estimate.reasons, OdometryReason::repeated_picture) << pair();
    }
    EXPECT_EQ(estimate.reset_counter, 0) << pair();
  }
  const double began = place(pair());
  OdometryEstimate estimate = show(began, began);
  EXPECT_FALSE(estimate.valid) << "the start of the motion is unknown";
  EXPECT_EQ(estimate.reset_counter, 1) << "the distance driven is unknown";
  for (int i = 0; i < 4; ++i) {
    const double step = place(pair()) - place(pair() - 1);
    estimate = show(place(pair()), place(pair()));
    ASSERT_TRUE(estimate.valid) << pair();
    EXPECT_NEAR(estimate.T_previous_current.translation().z(), step, 0.05 * step) << pair();
  }
}

/// The same while the cart is slow enough to stop within a pair.
TEST_F(FrozenAtStandstill, IsDetectedFromTheFirstPairSoonAfterTheStandstill) {
  constexpr int kFrozenFrom = kStands + 5, kEnd = kFrozenFrom + 15;  // at 0.34 m/s
  OdometryEstimate estimate;
  while (pair() < kFrozenFrom)
    estimate = show(place(pair()), place(pair()));
  EXPECT_TRUE(estimate.valid);
  const double frozen_place = place(pair() - 1);
  while (pair() < kEnd) {
    estimate = show(frozen_place, place(pair()));
    EXPECT_EQ(estimate.reasons, OdometryReason::repeated_picture) << pair();
  }
}

/// From 0.6 m/s at the limit of the tyres. Poses do not determine the place of a right camera that is exposed
/// later.
TEST_F(FrozenAtStandstill, IsNotDetectedWhenTheCartStopsSuddenly) {
  constexpr double kSpeed = 0.6, kBrakes = 8.0;  // m/s, m/s^2
  constexpr int kDrives = 8, kEnd = kDrives + 12;
  const auto at = [](double seconds) {
    const double braking = std::clamp(seconds - 1e-9 * kPeriod * kDrives, 0.0, kSpeed / kBrakes);
    return kSpeed * std::min(seconds, 1e-9 * kPeriod * kDrives) +
           (kSpeed - 0.5 * kBrakes * braking) * braking;
  };
  for (const std::int64_t late_ns : {0, 20'000'000, 45'000'000, -30'000'000}) {
    begin();
    for (int i = 0; i < kEnd; ++i) {
      const double time = 1e-9 * static_cast<double>(kPeriod * i);
      const OdometryEstimate estimate =
          show(at(time), at(time + 1e-9 * static_cast<double>(late_ns)), late_ns);
      EXPECT_EQ(estimate.valid, i > 0) << i << ", " << late_ns;
    }
  }
}

/// No image measures the motion during a long standstill, but its end is at rest.
TEST_F(FrozenAtStandstill, VelocityIsKnownAfterIt) {
  begin();
  int moving = 0;
  while (pair() < kStands + 12) {
    const int i = pair();
    const OdometryEstimate estimate = show(place(i), place(i));
    if (i <= kStands || estimate.reasons == OdometryReason::zero_velocity) continue;
    ++moving;
    EXPECT_TRUE(estimate.valid) << i;
    ASSERT_TRUE(estimate.twist);
    const double velocity = 1e-9 * kPeriod * (i - kStands) * kAccelerates;
    EXPECT_NEAR(estimate.twist->value[2], velocity, 0.1) << i;
    EXPECT_LT(std::sqrt(estimate.twist->covariance(2, 2)), 0.15) << i;
  }
  EXPECT_GT(moving, 8);
}

TEST_F(FrozenAtStandstill, RightCameraIsUsedAgainAfterAPush) {
  constexpr double kPushed = 0.01;  // m
  constexpr int kLeast = 7;         // pairs of the minimum time of a standstill, plus one
  while (pair() < kStands)
    show(0.0, 0.0);
  EXPECT_EQ(show(0.0, 0.0).reasons, OdometryReason::zero_velocity);
  EXPECT_EQ(show(0.0, kPushed).reasons, OdometryReason::repeated_picture);
  for (int i = 0; i < kLeast; ++i)
    show(0.0, kPushed);
  EXPECT_EQ(show(0.0, kPushed).reasons, OdometryReason::zero_velocity);
}

TEST_F(FrozenAtStandstill, IsNotDetectedDuringALongStandstill) {
  while (pair() < kStands)
    show(0.0, 0.0);
  while (pair() < 5 * kStands)
    EXPECT_EQ(show(0.0, 0.0).reasons, OdometryReason::zero_velocity) << pair();
}

/// At a speed that allows a stop within a pair the other camera shows that the cart has not stopped.
TEST(FrozenCameraOdometry, DetectsOneFrozenCameraOfASlowCart) {
  constexpr double kWalking = 0.02;  // m a pair: 0.4 m/s
  for (const Frozen frozen : {Frozen::left, Frozen::right}) {
    const auto estimates = driven(kWalking, frozen, Estimator::reprojection);
    for (int i = kFreezes; i < kRecovers; ++i)
      EXPECT_EQ(estimates[i].reasons, OdometryReason::repeated_picture) << i;
    EXPECT_TRUE(estimates.back().valid);
    EXPECT_NEAR(estimates.back().T_world_camera.translation().z(), kWalking * (kPairs - 1),
                0.05 * kWalking * kPairs);
  }
}

TEST(FrozenCameraOdometry, AcceptsTheSameImagesOfAStandingCartOnceASecond) {
  const test::CorridorWorld world(1);
  StereoOdometry odometry = odometryBy(Estimator::reprojection);
  NullStageObserver observer;
  constexpr std::int64_t kSecond = 1'000'000'000;
  for (int i = 0; i < 10; ++i) {
    const Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
    const StereoImages pair{world.view(kCamera, place), world.rightView(kCamera, place), i * kSecond,
                            i * kSecond};
    const OdometryEstimate estimate = odometry.process(pair, observer);
    EXPECT_EQ(estimate.valid, i > 0) << i;
    EXPECT_LT(estimate.T_world_camera.translation().norm(), 1e-3) << i;
  }
}

TEST(FrozenCameraOdometry, TreatsRepeatedImagesOfASlowCartAsAStop) {
  const auto estimates = driven(kSlow, Frozen::both, Estimator::reprojection);
  for (int i = kFreezes; i < kRecovers; ++i) {
    EXPECT_TRUE(estimates[i].valid) << i;
    EXPECT_LT(estimates[i].T_previous_current.translation().norm(), 0.1 * kSlow) << i;
  }
}

}  // namespace
}  // namespace cartvo::vo
