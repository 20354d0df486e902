// Tests of the estimation of a readout that nobody has stated.
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

/// The estimator after `images` of a camera with the readout `truth` (s), each with an error of `error` (s)
/// and stated as good as 2 ms.
ReadoutEstimator after(int images, double truth, double error = 0.0) {
  ReadoutEstimator readout({kUsual, kUnknown, {}}, {});
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, error);
  for (int i = 0; i < images; ++i)
    readout.update(imageOf(error > 0.0 ? truth + noise(random) : truth, 0.002, readout));
  return readout;
}

TEST(ReadoutEstimator, FollowsWhatTheImagesShow) {
  for (const double truth : {0.016, 0.030, 0.038}) {
    const ReadoutEstimator readout = after(40, truth);
    EXPECT_NEAR(readout.used(), truth, 0.001);
    EXPECT_FALSE(readout.isUnknown());
    EXPECT_NEAR(readout.estimate().value, truth, 3.0 * readout.estimate().stddev);
  }
}

TEST(ReadoutEstimator, RecognisesAGlobalShutter) {
  EXPECT_EQ(after(40, 0.0).used(), 0.0);
  EXPECT_EQ(after(40, 0.0, 0.004).used(), 0.0);
}

TEST(ReadoutEstimator, IsUnknownUntilImagesHaveShownIt) {
  EXPECT_TRUE(after(0, kUsual).isUnknown());
  EXPECT_TRUE(after(1, kUsual).isUnknown());
  EXPECT_FALSE(after(40, kUsual).isUnknown());
}

TEST(ReadoutEstimator, TrustsImagesLessThatScatterMoreThanStated) {
  const double steady = after(60, kUsual).stddev();
  const ReadoutEstimator scattering = after(60, kUsual, 0.02);
  EXPECT_GT(scattering.stddev(), 2.0 * steady);
  EXPECT_NEAR(scattering.used(), kUsual, 3.0 * scattering.stddev());
}

/// A vehicle that fills the image, or a polynomial that a gap spoils.
TEST(ReadoutEstimator, ForgetsAnImageThatMeasuresNonsense) {
  ReadoutEstimator readout = after(40, kUsual);
  readout.update(imageOf(1.0, 0.0004, readout));
  EXPECT_NEAR(readout.used(), kUsual, 0.013);
  EXPECT_LE(readout.stddev(), kUnknown + 0.001);
  for (int i = 0; i < 40; ++i)
    readout.update(imageOf(kUsual, 0.002, readout));
  EXPECT_NEAR(readout.used(), kUsual, 0.003);
  EXPECT_FALSE(readout.isUnknown());
}

TEST(ReadoutEstimator, StatesWhatItsLimitsLeaveOut) {
  const ReadoutEstimator readout = after(200, 0.06);
  EXPECT_LE(readout.used(), 0.045);
  EXPECT_NEAR(after(200, 0.004).stddev(), 0.004, 0.001) << "a global shutter that is none";
}

TEST(ReadoutEstimator, StaysWithinTheReadoutsOfCameras) {
  EXPECT_EQ(after(100, -0.5).used(), 0.0);
  EXPECT_LE(after(100, 0.5).used(), 0.045);
}

TEST(ReadoutEstimator, ChecksAKnownReadoutButKeepsIt) {
  ReadoutEstimator upside_down({-0.032, 0.0, {}}, {});
  upside_down.update(imageOf(0.02, 0.002, upside_down));
  EXPECT_EQ(upside_down.used(), -0.032);

  ReadoutEstimator readout({0.03, 0.0, {}}, {});
  for (int i = 0; i < 100; ++i)
    EXPECT_FALSE(readout.update(imageOf(0.027, 0.002, readout)));
  EXPECT_EQ(readout.used(), 0.03);
  EXPECT_EQ(readout.stddev(), 0.0);
  EXPECT_FALSE(readout.isUnknown());
  EXPECT_NEAR(readout.estimate().value, 0.027, 0.0005);
}

TEST(ReadoutEstimator, IgnoresEquationsThatAreNoNumbers) {
  ReadoutEstimator readout({kUsual, kUnknown, {}}, {});
  EXPECT_FALSE(readout.update({std::numeric_limits<double>::quiet_NaN(), 0.0}));
  EXPECT_FALSE(readout.update({1e6, std::numeric_limits<double>::infinity()}));
  EXPECT_FALSE(readout.update({0.0, 0.0}));
  EXPECT_EQ(readout.used(), kUsual);
}

}  // namespace
}  // namespace cartvo::vo
