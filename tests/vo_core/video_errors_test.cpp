// How far ahead key frames are and how much poses leap, learned from motions whose truth is known.
#include "vo_core/video_errors.hpp"

#include <cmath>
#include <optional>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "vo_core/synthetic_texture.hpp"

namespace cartvo {
namespace {

constexpr double kStep = 0.05;  // s
constexpr int kInterval = 12;   // pairs from key frame to key frame
constexpr KeyFrames kBoth{true, true}, kLeft{true, false}, kRight{false, true}, kNone{};

const Vector6d kDeviation = (Vector6d() << 2e-4, 2e-4, 3e-4, 2e-5, 3e-5, 2e-5).finished();
/// In standard deviations.
const Vector6d kAhead = (Vector6d() << 1.5, 0.0, -3.0, 0.5, 0.0, 1.0).finished();

/// Poses of a cart that speeds up, turns and sways, a vector each: small enough to be added up. `t` in s.
Vector6d truth(double t, double direction) {
  Vector6d pose;
  pose << 0.02 * std::sin(0.7 * t), 0.004 * std::sin(3.0 * t), direction * (3.0 * t + 0.3 * std::sin(t)),
      0.004 * std::sin(3.0 * t), 0.05 * std::sin(0.5 * t), 0.003 * std::sin(2.0 * t);
  return pose;
}

Vector6d noiseOf(test::Noise& noise) {
  Vector6d vector;
  for (double& value : vector)  // of four evenly distributed numbers, so that its variance is one
    value = std::sqrt(3.0) * (noise.uniform() + noise.uniform() + noise.uniform() + noise.uniform() - 2.0);
  return vector;
}

struct Drive {
  KeyFrames key_frames = kBoth;
  double direction = 1.0;
  Vector6d roughness = Vector6d::Zero();  ///< of poses, in standard deviations of motions, beyond noise
  double uneven = 0.0;                    ///< s; time steps are longer and shorter by this in turn
  bool guessed = false;                   ///< as ShownMotion's

  double instant(int pair) const { return kStep * pair + (pair % 2 == 0 ? 0.0 : uneven); }
};

/// What a drive tells whose key frames are ahead by kAhead.
struct Told {
  VideoErrors errors;
  std::vector<std::optional<PoseShift>> shifts;  ///< from the second pair on
};

Told toldBy(const Drive& drive, int pairs) {
  test::Noise noise(7);
  Told told;
  told.errors.begin(kNone);
  const Vector6d size = (drive.roughness.array().square() + 0.5).sqrt();
  Vector6d last = truth(0.0, drive.direction);
  for (int i = 1; i < pairs; ++i) {
    const bool is_key = i % kInterval == 0;
    Vector6d pose =
        truth(drive.instant(i), drive.direction) + size.cwiseProduct(kDeviation).cwiseProduct(noiseOf(noise));
    if (is_key) pose += drive.direction * kDeviation.cwiseProduct(kAhead);
    told.shifts.push_back(
        told.errors.next(is_key ? drive.key_frames : kNone,
                         {pose - last, kDeviation, drive.instant(i) - drive.instant(i - 1), drive.guessed}));
    last = pose;
  }
  return told;
}

std::vector<std::optional<PoseShift>> shiftsOf(const Drive& drive, int pairs) {
  return toldBy(drive, pairs).shifts;
}

double excessOf(const Drive& drive) {
  return toldBy(drive, 20 * kInterval).errors.excess();
}

Vector6d onAxis(int axis, double roughness) {
  return roughness * Vector6d::Unit(axis);
}

const PoseShift& lastOf(const std::vector<std::optional<PoseShift>>& shifts) {
  for (std::size_t i = shifts.size(); i-- > 0;)
    if (shifts[i]) return *shifts[i];
  throw std::runtime_error("no pair is shifted");
}

TEST(KeyFrameShift, IsLearnedFromHowPosesLeap) {
  const PoseShift shift = lastOf(shiftsOf({}, 60 * kInterval));
  const Vector6d found = shift.value.cwiseQuotient(kDeviation);
  EXPECT_LT((found - kAhead).cwiseAbs().maxCoeff(), 0.8) << found.transpose();
  EXPECT_LT((shift.variance.cwiseSqrt().cwiseQuotient(kDeviation)).maxCoeff(), 1.0);
}

TEST(KeyFrameShift, IsNotKnownAtFirstAndOwnsUpToIt) {
  const PoseShift shift = *shiftsOf({}, kInterval + 1).back();
  EXPECT_EQ(shift.value, Vector6d::Zero());
  EXPECT_GE((shift.variance.cwiseSqrt() - 1.5 * kDeviation).minCoeff(), 0.0);
}

TEST(KeyFrameShift, GoesWithTheMotionBackwards) {
  const PoseShift forwards = lastOf(shiftsOf({}, 60 * kInterval));
  const PoseShift backwards = lastOf(shiftsOf({.direction = -1.0}, 60 * kInterval));
  EXPECT_LT((forwards.value + backwards.value).cwiseQuotient(kDeviation).cwiseAbs().maxCoeff(), 1.0);
  EXPECT_GT(backwards.value.z(), 1.5 * kDeviation.z());
}

TEST(KeyFrameShift, IsTheSameForOneCamerasKeyFrames) {
  for (const KeyFrames key_frames : {kLeft, kRight}) {
    const PoseShift shift = lastOf(shiftsOf({.key_frames = key_frames}, 60 * kInterval));
    EXPECT_NEAR(shift.value.z() / kDeviation.z(), kAhead.z(), 0.8);
  }
}

TEST(KeyFrameShift, IsLearnedFromStepsThatAlternate) {
  const PoseShift shift = lastOf(shiftsOf({.uneven = 0.3 * kStep}, 60 * kInterval));
  EXPECT_NEAR(shift.value.z() / kDeviation.z(), kAhead.z(), 1.2);
}

TEST(KeyFrameShift, IsNotSoughtInARoughRoad) {
  const PoseShift shift = lastOf(shiftsOf({.roughness = Vector6d::Constant(20.0)}, 60 * kInterval));
  EXPECT_LT(shift.value.cwiseQuotient(kDeviation).cwiseAbs().maxCoeff(), 3.0);
}

TEST(KeyFrameShift, IsOfKeyFramesOnly) {
  const auto shifts = shiftsOf({}, 3 * kInterval);
  for (std::size_t i = 0; i < shifts.size(); ++i)
    EXPECT_EQ(shifts[i].has_value(), (i + 1) % kInterval == 0) << i;
}

TEST(KeyFrameShift, IsNoneWhereThereIsNothingButKeyFrames) {
  VideoErrors errors;
  errors.begin(kBoth);
  for (int i = 1; i < 50; ++i)
    EXPECT_FALSE(
        errors.next(kBoth, {truth(kStep * i, 1.0) - truth(kStep * (i - 1), 1.0), kDeviation, kStep}));
}

TEST(KeyFrameShift, OfAPairThatNoMotionLeadsToIsUncertain) {
  VideoErrors errors;
  EXPECT_LE(errors.begin(kBoth)->variance.maxCoeff(), 0.0)
      << "nothing is known of how well motions are known";
  errors.next(kNone, {truth(kStep, 1.0), kDeviation, kStep});
  const auto again = errors.begin(kBoth);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->value, Vector6d::Zero());
  EXPECT_GE((again->variance.cwiseSqrt() - 1.5 * kDeviation).minCoeff(), 0.0);
}

TEST(VideoExcess, IsNoneWherePosesErrAsTheirLandmarksSay) {
  EXPECT_LT(excessOf({}), 1.4);
  EXPECT_GE(excessOf({}), 1.0);
}

TEST(VideoExcess, IsHowMuchMorePosesLeap) {
  Drive dusk;
  dusk.roughness = onAxis(2, 1.2) + onAxis(4, 1.2);  // standard deviations of motions; sqrt(0.5) is foretold
  const double whole = (1.2 * 1.2 + 0.5) / 0.5;
  EXPECT_NEAR(excessOf(dusk), whole, 0.35 * whole) << "of what twenty pairs have shown";
}

TEST(VideoExcess, IsNotThatOfABumpyRoad) {
  for (const int axis : {0, 1, 3, 5}) {
    Drive bumpy;
    bumpy.roughness = onAxis(axis, 5.0);
    EXPECT_LT(excessOf(bumpy), 1.4) << axis;
  }
}

TEST(VideoExcess, IsNotThatOfUnevenSteps) {
  for (const double uneven : {0.0005, 0.002, 0.3 * kStep}) {  // at 3 m/s: millimetres to decimetres
    Drive drive;
    drive.uneven = uneven;
    EXPECT_LT(excessOf(drive), 1.4) << uneven;
  }
}

TEST(VideoExcess, IsNotLearnedFromGuesses) {
  Drive first;
  first.roughness = Vector6d::Constant(5.0);
  first.guessed = true;
  EXPECT_EQ(excessOf(first), 1.0);
}

TEST(VideoExcess, IsBounded) {
  Drive wild;
  wild.roughness = Vector6d::Constant(100.0);
  EXPECT_EQ(excessOf(wild), 30.0);
}

TEST(VideoExcess, IsNotKnownAtFirst) {
  EXPECT_EQ(VideoErrors().excess(), 1.0);
}

TEST(VideoExcess, OutlastsAStand) {
  Drive dusk;
  dusk.roughness = Vector6d::Constant(1.5);
  Told told = toldBy(dusk, 5 * kInterval);
  const double before = told.errors.excess();
  EXPECT_GT(before, 2.0);
  told.errors.begin(kNone);
  EXPECT_EQ(told.errors.excess(), before);
}

}  // namespace
}  // namespace cartvo
