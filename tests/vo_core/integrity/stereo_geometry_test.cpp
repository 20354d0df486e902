// Tests of gross faults of the rig through the public facade, in a rendered corridor.
#include <algorithm>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "support/vo_core/corridor_world.hpp"
#include "vo_core/stereo_odometry.hpp"

namespace cartvo::vo {
namespace {

const StereoCamera kCamera{220.0, 160.0, 80.0, 0.2, 320, 160};
constexpr std::int64_t kPeriod = 200'000'000;  // ns, the longest with which a fault is named within 5 s
constexpr int kPairs = 32;
constexpr int kNamedWithin = 12;  // pairs, if the fault is there from the start

Eigen::Isometry3d drive(double frame) {
  Vector6d vector;
  vector << 0.005 * frame, 0.0, 0.3 * frame, 0.0, 0.002 * frame, 0.0;
  return motionFromVector(vector);
}

std::int64_t instant(int frame) {
  return (1 + frame) * kPeriod;
}

const test::CorridorWorld& world() {
  static const test::CorridorWorld corridor(3);
  return corridor;
}

/// The pairs of a correct rig, rendered once.
const std::vector<StereoImages>& drivePairs() {
  static const std::vector<StereoImages> pairs = [] {
    std::vector<StereoImages> rendered;
    for (int i = 0; i < kPairs; ++i)
      rendered.push_back(world().render(kCamera, drive(i), instant(i)));
    return rendered;
  }();
  return pairs;
}

/// The first pairs of the drive with the right image of a camera that is turned by `rotation`.
std::vector<StereoImages> turnedPairs(int count, const Eigen::AngleAxisd& rotation) {
  std::vector<StereoImages> pairs(drivePairs().begin(), drivePairs().begin() + count);
  for (int i = 0; i < count; ++i)
    pairs[i].right =
        world().view(kCamera, drive(i) * Eigen::Translation3d(kCamera.baseline, 0.0, 0.0) * rotation);
  return pairs;
}

void swapImages(StereoImages& pair) {
  std::swap(pair.left, pair.right);
}

class StereoFaults : public testing::TestWithParam<Estimator> {
 protected:
  StereoFaults() : odometry_(kCamera, settings()) {}

  static OdometrySettings settings() {
    OdometrySettings settings;
    settings.estimator = GetParam();
    settings.features = 300;
    return settings;
  }

  OdometryEstimate process(const StereoImages& pair) {
    NullStageObserver observer;
    return odometry_.process(pair, observer);
  }

  /// Expects that no pair is valid after `invalid_from`, and that the fault is named within `named_within`.
  void expectFault(const std::vector<StereoImages>& pairs, StereoFault fault, int invalid_from,
                   int named_within) {
    std::optional<int> named;
    for (int i = 0; i < static_cast<int>(pairs.size()); ++i) {
      const OdometryEstimate estimate = process(pairs[i]);
      if (i >= invalid_from) {
        EXPECT_FALSE(estimate.valid) << i;
      }
      if (!named && estimate.stereo_fault == fault) named = i;
      if (!named) continue;
      EXPECT_EQ(estimate.stereo_fault, fault) << i;
      EXPECT_EQ(estimate.reasons, OdometryReason::wrong_stereo_geometry) << i;
    }
    ASSERT_TRUE(named);
    EXPECT_LE(*named, named_within);
  }

  StereoOdometry odometry_;
};
INSTANTIATE_TEST_SUITE_P(Odometry, StereoFaults, testing::Values(Estimator::reprojection, Estimator::thesis),
                         [](const auto& tested) {
                           return tested.param == Estimator::thesis ? "Thesis" : "Reprojection";
                         });

TEST_P(StereoFaults, CorrectPairsHaveNone) {
  for (const StereoImages& pair : drivePairs()) {
    const OdometryEstimate estimate = process(pair);
    EXPECT_EQ(estimate.stereo_fault, StereoFault::none);
    EXPECT_EQ(estimate.valid, pair.left_exposure_ns != instant(0));
  }
}

TEST_P(StereoFaults, SamePictureIsNamedAtOnce) {
  std::vector<StereoImages> pairs = drivePairs();
  for (StereoImages& pair : pairs)
    pair.right = pair.left.clone();
  expectFault(pairs, StereoFault::same_picture, 0, 0);
}

TEST_P(StereoFaults, SamePictureIsNamedByTheImagesBeforeRectification) {
  std::vector<StereoImages> pairs = drivePairs();
  for (StereoImages& pair : pairs)
    pair.left_digest = pair.right_digest = 1 + static_cast<std::uint64_t>(pair.left_exposure_ns);
  expectFault(pairs, StereoFault::same_picture, 0, 0);
}

TEST_P(StereoFaults, SamePictureIsNamedIfPairingShiftsIt) {
  std::vector<StereoImages> pairs = drivePairs();
  for (std::size_t i = pairs.size() - 1; i > 0; --i)
    pairs[i].right = pairs[i - 1].left.clone();
  expectFault(pairs, StereoFault::same_picture, 1, 1);
}

TEST_P(StereoFaults, UniformPicturesMayBeEqual) {
  StereoImages dark = drivePairs()[0];
  dark.left = cv::Mat(kCamera.height, kCamera.width, CV_8UC1, cv::Scalar(16));
  dark.right = dark.left.clone();
  EXPECT_EQ(process(dark).stereo_fault, StereoFault::none);
}

TEST_P(StereoFaults, ExchangedImagesAreNamed) {
  std::vector<StereoImages> pairs = drivePairs();
  std::for_each(pairs.begin(), pairs.end(), swapImages);
  expectFault(pairs, StereoFault::swapped, 0, kNamedWithin);
}

TEST_P(StereoFaults, RowsThatDisagreeAreNamed) {
  expectFault(turnedPairs(16, Eigen::AngleAxisd(0.03, Eigen::Vector3d::UnitX())), StereoFault::misaligned, 0,
              kNamedWithin);
}

TEST_P(StereoFaults, SmallRotationIsLeftToSelfCalibration) {
  for (const Eigen::Vector3d& axis : {Eigen::Vector3d(1.0, 0.0, 0.0), Eigen::Vector3d(0.0, 1.0, 0.0)}) {
    odometry_ = StereoOdometry(kCamera, settings());
    for (const StereoImages& pair : turnedPairs(6, Eigen::AngleAxisd(0.008, axis)))
      EXPECT_EQ(process(pair).stereo_fault, StereoFault::none) << axis.transpose();
  }
}

TEST_P(StereoFaults, RightImagesOfTheNextOrPreviousPairAreNamed) {
  for (const int lag : {-1, 1}) {
    odometry_ = StereoOdometry(kCamera, settings());
    std::vector<StereoImages> pairs(drivePairs().begin() + 1, drivePairs().begin() + 18);
    for (int i = 0; i < static_cast<int>(pairs.size()); ++i)
      pairs[i].right = drivePairs()[i + 1 + lag].right;
    expectFault(pairs, StereoFault::period_offset, 2, kNamedWithin + 2);
  }
}

TEST_P(StereoFaults, OffsetThatTheTimestampsTellIsNone) {
  for (int i = 0; i < 12; ++i) {
    StereoImages pair = drivePairs()[i];
    pair.right = drivePairs()[i + 1].right;
    pair.right_exposure_ns = instant(i + 1);
    EXPECT_EQ(process(pair).stereo_fault, StereoFault::none) << i;
  }
}

TEST_P(StereoFaults, FaultAfterACorrectStartIsNamedWithinSeconds) {
  constexpr int kFirst = 6;
  constexpr std::int64_t kNamedWithin_ns = 5'000'000'000;
  std::vector<StereoImages> pairs = drivePairs();
  std::for_each(pairs.begin() + kFirst, pairs.end(), swapImages);
  std::optional<std::int64_t> named_ns;
  for (const StereoImages& pair : pairs) {
    const OdometryEstimate estimate = process(pair);
    if (!named_ns && estimate.stereo_fault == StereoFault::swapped) named_ns = pair.left_exposure_ns;
    EXPECT_NE(estimate.stereo_fault, StereoFault::suspected);  // the rig was seen to be right
  }
  ASSERT_TRUE(named_ns);
  EXPECT_LE(*named_ns - pairs[kFirst].left_exposure_ns, kNamedWithin_ns);
}

TEST_P(StereoFaults, FaultEndsWithANewEpoch) {
  std::vector<StereoImages> pairs = drivePairs();
  for (int i = 4; i < 8; ++i)
    pairs[i].right = pairs[i].left.clone();
  std::optional<std::uint32_t> epoch;
  for (int i = 0; i < kPairs; ++i) {
    const OdometryEstimate estimate = process(pairs[i]);
    if (i == 3) {
      EXPECT_EQ(estimate.reset_counter, 0U);
    }
    if (i >= 4 && i < 20) {
      EXPECT_EQ(estimate.stereo_fault, StereoFault::same_picture) << i;
    }
    if (i >= 8 && estimate.valid) epoch = estimate.reset_counter;
  }
  EXPECT_EQ(epoch, 1U);
}

}  // namespace
}  // namespace cartvo::vo
