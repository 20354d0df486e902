// Tests of the normalised estimation error and its band.
#include "tools/evaluate/consistency.hpp"

#include <Eigen/Cholesky>
#include <random>

#include <gtest/gtest.h>

namespace cartvo {
namespace {

/// A covariance with correlated dimensions of different size.
vo::Matrix6d exampleCovariance() {
  vo::Matrix6d root = vo::Matrix6d::Zero();
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column <= row; ++column)
      root(row, column) = row == column ? 0.01 * (row + 1) : 0.003 * (row - column);
  }
  return root * root.transpose();
}

/// Random errors with the given covariance.
class Errors {
 public:
  explicit Errors(const vo::Matrix6d& covariance) : root_(covariance.llt().matrixL()) {}

  vo::Vector6d next() {
    vo::Vector6d white;
    for (double& value : white)
      value = normal_(generator_);
    return root_ * white;
  }

 private:
  vo::Matrix6d root_;
  std::mt19937 generator_{20161};
  std::normal_distribution<double> normal_;
};

/// `count` errors of exampleCovariance, normalised by the `stated` covariance.
NormalisedErrors measure(const vo::Matrix6d& stated, int count) {
  Errors errors(exampleCovariance());
  NormalisedErrors normalised;
  for (int i = 0; i < count; ++i) {
    normalised.beginGroup();
    normalised.add(errors.next(), stated);
  }
  return normalised;
}

TEST(NormalisedErrors, AverageOneInsideTheBandWithTheTrueCovariance) {
  const NormalisedErrors normalised = measure(exampleCovariance(), 2000);
  EXPECT_EQ(normalised.groups(), 2000u);
  EXPECT_NEAR(normalised.mean(), 1.0, 0.04);
  EXPECT_TRUE(normalised.band().contains(normalised.mean())) << normalised.mean();
}

TEST(NormalisedErrors, AverageTwoAboveTheBandWithHalfTheCovariance) {
  const NormalisedErrors normalised = measure(0.5 * exampleCovariance(), 100);
  EXPECT_NEAR(normalised.mean(), 2.0, 0.3);
  EXPECT_GT(normalised.mean(), normalised.band().high);
}

TEST(NormalisedErrors, AverageOneHalfBelowTheBandWithTwiceTheCovariance) {
  const NormalisedErrors normalised = measure(2.0 * exampleCovariance(), 100);
  EXPECT_NEAR(normalised.mean(), 0.5, 0.1);
  EXPECT_LT(normalised.mean(), normalised.band().low);
}

TEST(NormalisedErrors, CountAGroupAsOneSample) {
  const vo::Matrix6d identity = vo::Matrix6d::Identity();
  NormalisedErrors normalised;
  normalised.beginGroup();
  for (int i = 0; i < 100; ++i)
    normalised.add(vo::Vector6d::Constant(1.0), identity);
  normalised.beginGroup();
  normalised.add(vo::Vector6d::Constant(2.0), identity);
  EXPECT_EQ(normalised.groups(), 2u);
  EXPECT_DOUBLE_EQ(normalised.mean(), (1.0 + 4.0) / 2.0);
}

TEST(NormalisedErrors, CountUnusableCovariances) {
  NormalisedErrors normalised;
  normalised.beginGroup();
  normalised.add(vo::Vector6d::Zero(), vo::Matrix6d::Zero());
  normalised.add(vo::Vector6d::Zero(), vo::Matrix6d::Constant(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_EQ(normalised.groups(), 0u);
  EXPECT_EQ(normalised.unusable(), 2u);
}

// Quantiles of chi-square with 6, 60 and 6000 degrees of freedom: the first two from tables, the last from
// the Wilson-Hilferty approximation, which is exact to these digits.
TEST(ConsistencyBand, MatchesChiSquareQuantiles) {
  EXPECT_NEAR(consistencyBand(1).low, 1.237344 / 6.0, 1e-5);
  EXPECT_NEAR(consistencyBand(1).high, 14.449375 / 6.0, 1e-5);
  EXPECT_NEAR(consistencyBand(10).low, 40.48175 / 60.0, 1e-5);
  EXPECT_NEAR(consistencyBand(10).high, 83.29767 / 60.0, 1e-5);
  EXPECT_NEAR(consistencyBand(1000).low, 0.96454, 2e-4);
  EXPECT_NEAR(consistencyBand(1000).high, 1.03610, 2e-4);
}

}  // namespace
}  // namespace cartvo
