// Tests of the estimation of a readout that is not stated.
#include "vo_core/self_calibration/readout_estimator.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace cartvo::vo {
namespace {

constexpr double kUsual = 0.032, kUnknown = 0.0128;  // s

/// Equation of an image that measures `truth` with `stddev` (s) about the readout in use.
ReadoutEquation imageOf(double truth, double stddev, const ReadoutEstimator& readout) {
  const double information = 1.0 / (stddev * stddev);
  return {information, information * (truth - readout.used())};
}

/// Both cameras after `images` of a left one with the readout `truth` (s), each with an error of `error` (s)
/// and stated as good as 2 ms. The right camera's readout is known.
ReadoutEstimators after(int images, double truth, double error = 0.0) {
  ReadoutEstimators readouts({{kUsual, kUnknown, {}}, {0.03, 0.0, {}}}, {});
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, error);
  for (int i = 0; i < images; ++i) {
    readouts.left.update(imageOf(error > 0.0 ? truth + noise(random) : truth, 0.002, readouts.left));
    readouts.choose();
  }
  return readouts;
}

TEST(ReadoutEstimator, FollowsWhatTheImagesShow) {
  for (const double truth : {0.016, 0.030, 0.038}) {
    const ReadoutEstimator readout = after(40, truth).left;
    EXPECT_NEAR(readout.used(), truth, 0.001);
    EXPECT_FALSE(readout.isUnknown());
    EXPECT_NEAR(readout.estimate().value, truth, 3.0 * readout.estimate().stddev);
  }
}

TEST(ReadoutEstimator, RecognisesAGlobalShutter) {
  EXPECT_EQ(after(40, 0.0).left.used(), 0.0);
  EXPECT_EQ(after(40, 0.0, 0.004).left.used(), 0.0);
}

TEST(ReadoutEstimator, IsUnknownUntilImagesHaveShownIt) {
  EXPECT_TRUE(after(0, kUsual).left.isUnknown());
  EXPECT_TRUE(after(1, kUsual).left.isUnknown());
  EXPECT_FALSE(after(40, kUsual).left.isUnknown());
}

TEST(ReadoutEstimator, TrustsImagesLessThatScatterMoreThanStated) {
  const double steady = after(60, kUsual).left.stddev();
  const ReadoutEstimator scattering = after(60, kUsual, 0.02).left;
  EXPECT_GT(scattering.stddev(), 1.5 * steady);
  EXPECT_NEAR(scattering.used(), kUsual, 3.0 * scattering.stddev());
}

/// A vehicle that fills the image, or a polynomial that a gap spoils.
TEST(ReadoutEstimator, ForgetsAnImageThatMeasuresNonsense) {
  ReadoutEstimators readouts = after(40, kUsual);
  ReadoutEstimator& readout = readouts.left;
  readout.update(imageOf(1.0, 0.0004, readout));
  readouts.choose();
  EXPECT_NEAR(readout.used(), kUsual, 0.013);
  EXPECT_LE(readout.stddev(), kUnknown + 0.001);
  for (int i = 0; i < 40; ++i) {
    readout.update(imageOf(kUsual, 0.002, readout));
    readouts.choose();
  }
  EXPECT_NEAR(readout.used(), kUsual, 0.003);
  EXPECT_FALSE(readout.isUnknown());
}

/// Both cameras unknown, after 40 images of each.
ReadoutEstimators bothAfter(double left, double right) {
  ReadoutEstimators readouts({{kUsual, kUnknown, {}}, {kUsual, kUnknown, {}}}, {});
  for (int i = 0; i < 40; ++i) {
    readouts.left.update(imageOf(left, 0.002, readouts.left));
    readouts.right.update(imageOf(right, 0.002, readouts.right));
    readouts.choose();
  }
  return readouts;
}

TEST(ReadoutEstimators, TimeBothCamerasAlikeUntilTheyDiffer) {
  const ReadoutEstimators alike = bothAfter(0.0300, 0.0303);
  EXPECT_EQ(alike.left.used(), alike.right.used());
  const ReadoutEstimators different = bothAfter(0.030, 0.036);
  EXPECT_NEAR(different.left.used(), 0.030, 0.0005);
  EXPECT_NEAR(different.right.used(), 0.036, 0.0005);
}

TEST(ReadoutEstimator, StatesWhatItsLimitsLeaveOut) {
  const ReadoutEstimator readout = after(200, 0.06).left;
  EXPECT_LE(readout.used(), 0.045);
  EXPECT_NEAR(after(200, 0.004).left.stddev(), 0.004, 0.001) << "taken for a global shutter";
}

TEST(ReadoutEstimator, StaysWithinTheReadoutsOfCameras) {
  EXPECT_EQ(after(100, -0.5).left.used(), 0.0);
  EXPECT_LE(after(100, 0.5).left.used(), 0.045);
}

TEST(ReadoutEstimator, ChecksAKnownReadoutButKeepsIt) {
  ReadoutEstimators readouts({{0.03, 0.0, {}}, {-0.032, 0.0, {}}}, {});
  for (int i = 0; i < 100; ++i) {
    readouts.left.update(imageOf(0.027, 0.002, readouts.left));
    readouts.right.update(imageOf(0.02, 0.002, readouts.right));
    EXPECT_FALSE(readouts.choose());
  }
  EXPECT_EQ(readouts.right.used(), -0.032) << "from bottom to top";
  const ReadoutEstimator& readout = readouts.left;
  EXPECT_EQ(readout.used(), 0.03);
  EXPECT_EQ(readout.stddev(), 0.0);
  EXPECT_FALSE(readout.isUnknown());
  EXPECT_NEAR(readout.estimate().value, 0.027, 0.0005);
}

TEST(ReadoutEstimator, IgnoresEquationsThatAreNoNumbers) {
  ReadoutEstimators readouts({{kUsual, kUnknown, {}}, {}}, {});
  readouts.left.update({std::numeric_limits<double>::quiet_NaN(), 0.0});
  readouts.left.update({1e6, std::numeric_limits<double>::infinity()});
  readouts.left.update({0.0, 0.0});
  EXPECT_FALSE(readouts.choose());
  EXPECT_EQ(readouts.left.used(), kUsual);
}

}  // namespace
}  // namespace cartvo::vo
