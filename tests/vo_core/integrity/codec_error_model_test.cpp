// Tests of the codec error model on simulated motions: shift of key frames, inflation between them.
#include "vo_core/integrity/codec_error_model.hpp"

#include <cmath>
#include <optional>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "support/vo_core/synthetic_texture.hpp"

namespace cartvo::vo {
namespace {

constexpr double kStep = 0.05;  // s
constexpr int kInterval = 12;   // pairs from key frame to key frame
constexpr KeyFrames kBoth{true, true}, kLeft{true, false}, kRight{false, true}, kNone{};

const Vector6d kStddev = (Vector6d() << 2e-4, 2e-4, 3e-4, 2e-5, 3e-5, 2e-5).finished();
/// Shift of key frames in standard deviations.
const Vector6d kAhead = (Vector6d() << 1.5, 0.0, -3.0, 0.5, 0.0, 1.0).finished();

/// Pose, as a vector, of a cart that accelerates, turns and sways; small enough to be added. `t` in s.
Vector6d truth(double t, double direction) {
  Vector6d pose;
  pose << 0.02 * std::sin(0.7 * t), 0.004 * std::sin(3.0 * t), direction * (3.0 * t + 0.3 * std::sin(t)),
      0.004 * std::sin(3.0 * t), 0.05 * std::sin(0.5 * t), 0.003 * std::sin(2.0 * t);
  return pose;
}

Vector6d noiseOf(test::Noise& noise) {
  Vector6d vector;
  for (double& value : vector)  // sum of four uniform numbers with a variance of one
    value = std::sqrt(3.0) * (noise.uniform() + noise.uniform() + noise.uniform() + noise.uniform() - 2.0);
  return vector;
}

struct Drive {
  KeyFrames key_frames = kBoth;
  double direction = 1.0;
  Vector6d roughness = Vector6d::Zero();  ///< of poses, in standard deviations of motions, beyond noise
  double uneven = 0.0;                    ///< s; time steps are longer and shorter by this in turn
  bool noise_uncalibrated = false;        ///< as MeasuredMotion's

  double instant(int pair) const { return kStep * pair + (pair % 2 == 0 ? 0.0 : uneven); }
};

/// Model and shifts after a drive whose key frames are ahead by kAhead.
struct Result {
  CodecErrorModel errors;
  std::vector<std::optional<PoseShift>> shifts;  ///< from the second pair on
};

Result simulate(const Drive& drive, int pairs) {
  test::Noise noise(7);
  Result result;
  result.errors.restart(kNone);
  const Vector6d size = (drive.roughness.array().square() + 0.5).sqrt();
  Vector6d last = truth(0.0, drive.direction);
  for (int i = 1; i < pairs; ++i) {
    const bool is_key = i % kInterval == 0;
    Vector6d pose =
        truth(drive.instant(i), drive.direction) + size.cwiseProduct(kStddev).cwiseProduct(noiseOf(noise));
    if (is_key) pose += drive.direction * kStddev.cwiseProduct(kAhead);
    result.shifts.push_back(result.errors.update(
        is_key ? drive.key_frames : kNone,
        {pose - last, kStddev, drive.instant(i) - drive.instant(i - 1), drive.noise_uncalibrated}));
    last = pose;
  }
  return result;
}

std::vector<std::optional<PoseShift>> shiftsOf(const Drive& drive, int pairs) {
  return simulate(drive, pairs).shifts;
}

double inflationOf(const Drive& drive) {
  return simulate(drive, 20 * kInterval).errors.poseNoiseInflation();
}

Vector6d onAxis(int axis, double roughness) {
  return roughness * Vector6d::Unit(axis);
}

const PoseShift& lastOf(const std::vector<std::optional<PoseShift>>& shifts) {
  for (std::size_t i = shifts.size(); i-- > 0;)
    if (shifts[i]) return *shifts[i];
  throw std::runtime_error("no pair is shifted");
}

TEST(KeyFrameShift, IsEstimatedFromThePoses) {
  const PoseShift shift = lastOf(shiftsOf({}, 60 * kInterval));
  const Vector6d found = shift.value.cwiseQuotient(kStddev);
  EXPECT_LT((found - kAhead).cwiseAbs().maxCoeff(), 0.8) << found.transpose();
  EXPECT_LT((shift.variance.cwiseSqrt().cwiseQuotient(kStddev)).maxCoeff(), 1.0);
}

TEST(KeyFrameShift, IsUncertainInitially) {
  const auto shifts = shiftsOf({}, kInterval + 1);
  ASSERT_FALSE(shifts.empty());
  ASSERT_TRUE(shifts.back().has_value());
  const PoseShift shift = *shifts.back();
  EXPECT_EQ(shift.value, Vector6d::Zero());
  EXPECT_GE((shift.variance.cwiseSqrt() - 1.5 * kStddev).minCoeff(), 0.0);
}

TEST(KeyFrameShift, ReversesWithTheMotion) {
  const PoseShift forwards = lastOf(shiftsOf({}, 60 * kInterval));
  const PoseShift backwards = lastOf(shiftsOf({.direction = -1.0}, 60 * kInterval));
  EXPECT_LT((forwards.value + backwards.value).cwiseQuotient(kStddev).cwiseAbs().maxCoeff(), 1.0);
  EXPECT_GT(backwards.value.z(), 1.5 * kStddev.z());
}

TEST(KeyFrameShift, IsEstimatedForKeyFramesOfOneCamera) {
  for (const KeyFrames key_frames : {kLeft, kRight}) {
    const PoseShift shift = lastOf(shiftsOf({.key_frames = key_frames}, 60 * kInterval));
    EXPECT_NEAR(shift.value.z() / kStddev.z(), kAhead.z(), 0.8);
  }
}

TEST(KeyFrameShift, IsEstimatedWithAlternatingTimeSteps) {
  const PoseShift shift = lastOf(shiftsOf({.uneven = 0.3 * kStep}, 60 * kInterval));
  EXPECT_NEAR(shift.value.z() / kStddev.z(), kAhead.z(), 1.2);
}

TEST(KeyFrameShift, IsBoundedOnARoughRoad) {
  const PoseShift shift = lastOf(shiftsOf({.roughness = Vector6d::Constant(20.0)}, 60 * kInterval));
  EXPECT_LT(shift.value.cwiseQuotient(kStddev).cwiseAbs().maxCoeff(), 3.0);
}

TEST(KeyFrameShift, ExistsForKeyFramesOnly) {
  const auto shifts = shiftsOf({}, 3 * kInterval);
  for (std::size_t i = 0; i < shifts.size(); ++i)
    EXPECT_EQ(shifts[i].has_value(), (i + 1) % kInterval == 0) << i;
}

TEST(KeyFrameShift, IsEmptyInAStreamOfKeyFramesOnly) {
  CodecErrorModel errors;
  errors.restart(kBoth);
  for (int i = 1; i < 50; ++i)
    EXPECT_FALSE(errors.update(kBoth, {truth(kStep * i, 1.0) - truth(kStep * (i - 1), 1.0), kStddev, kStep}));
}

TEST(KeyFrameShift, IsUncertainAfterARestart) {
  CodecErrorModel errors;
  const auto first = errors.restart(kBoth);
  ASSERT_TRUE(first);
  EXPECT_LE(first->variance.maxCoeff(), 0.0) << "the standard deviations of motions are not known yet";
  errors.update(kNone, {truth(kStep, 1.0), kStddev, kStep});
  const auto again = errors.restart(kBoth);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->value, Vector6d::Zero());
  EXPECT_GE((again->variance.cwiseSqrt() - 1.5 * kStddev).minCoeff(), 0.0);
}

TEST(PoseNoiseInflation, IsOneWithoutCodecErrors) {
  EXPECT_LT(inflationOf({}), 1.4);
  EXPECT_GE(inflationOf({}), 1.0);
}

TEST(PoseNoiseInflation, AgreesWithTheRoughnessOfPoses) {
  Drive dusk;
  dusk.roughness = onAxis(2, 1.2) + onAxis(4, 1.2);  // standard deviations of motions; sqrt(0.5) is predicted
  const double whole = (1.2 * 1.2 + 0.5) / 0.5;
  EXPECT_NEAR(inflationOf(dusk), whole, 0.35 * whole) << "from a memory of twenty pairs";
}

TEST(PoseNoiseInflation, IgnoresBumpsOfTheRoad) {
  for (const int axis : {0, 1, 3, 5}) {
    Drive bumpy;
    bumpy.roughness = onAxis(axis, 5.0);
    EXPECT_LT(inflationOf(bumpy), 1.4) << axis;
  }
}

TEST(PoseNoiseInflation, IgnoresUnevenTimeSteps) {
  for (const double uneven : {0.0005, 0.002, 0.3 * kStep}) {  // at 3 m/s: millimetres to decimetres
    Drive drive;
    drive.uneven = uneven;
    EXPECT_LT(inflationOf(drive), 1.4) << uneven;
  }
}

TEST(PoseNoiseInflation, IsNotUpdatedByUncalibratedNoise) {
  Drive first;
  first.roughness = Vector6d::Constant(5.0);
  first.noise_uncalibrated = true;
  EXPECT_EQ(inflationOf(first), 1.0);
}

TEST(PoseNoiseInflation, IsBounded) {
  Drive wild;
  wild.roughness = Vector6d::Constant(100.0);
  EXPECT_EQ(inflationOf(wild), 30.0);
}

TEST(PoseNoiseInflation, IsOneInitially) {
  EXPECT_EQ(CodecErrorModel().poseNoiseInflation(), 1.0);
}

TEST(PoseNoiseInflation, IsKeptDuringAStandstill) {
  Drive dusk;
  dusk.roughness = Vector6d::Constant(1.5);
  Result result = simulate(dusk, 5 * kInterval);
  const double before = result.errors.poseNoiseInflation();
  EXPECT_GT(before, 2.0);
  result.errors.restart(kNone);
  EXPECT_EQ(result.errors.poseNoiseInflation(), before);
}

}  // namespace
}  // namespace cartvo::vo
