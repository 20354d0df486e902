// What one pair's rows tell of the right camera.
#include "vo_core/row_evidence.hpp"

#include <Eigen/LU>
#include <cmath>

#include <gtest/gtest.h>

#include "vo_core/landmark_scene.hpp"

namespace cartvo {
namespace {

constexpr double kDegree = M_PI / 180.0;
constexpr int kLandmarks = 400;

/// rad and s.
void expectErrors(const RowEvidence& evidence, const RowErrors::Vector& truth, double angle, double delay) {
  for (const RowErrors::Index index : {RowErrors::kPitch, RowErrors::kRoll, RowErrors::kKeystone})
    EXPECT_NEAR(evidence.errors[index], truth[index], angle) << index;
  EXPECT_NEAR(evidence.errors[RowErrors::kDelay], truth[RowErrors::kDelay], delay);
}

TEST(RowEvidence, FindsHowTheRightCameraIsTurned) {
  const RigCorrection rig{.yaw = 1e-3, .pitch = 0.3 * kDegree, .roll = -0.3 * kDegree};
  for (const double offset : {0.0, 0.02, -0.02}) {
    const BundleProblem problem = test::seenBy({.landmarks = kLandmarks, .offset = offset, .rig = rig}, 1);
    expectErrors(rowEvidence(problem), {rig.pitch, rig.roll, rig.yaw, 0.0}, 5e-5, 1e-4);
  }
}

TEST(RowEvidence, FindsHowMuchLaterTheRightCameraIsExposed) {
  for (const double offset : {0.0, 0.02, -0.02})
    for (const double delay : {-3e-3, 3e-3}) {
      const BundleProblem problem =
          test::seenBy({.landmarks = kLandmarks, .offset = offset, .delay = delay}, 1);
      expectErrors(rowEvidence(problem), {0.0, 0.0, 0.0, delay}, 1e-4, 1e-4);
    }
}

TEST(RowEvidence, IsNotMisledByMatchesThatAreSomewhereElse) {
  BundleProblem problem =
      test::seenBy({.landmarks = kLandmarks, .noise = 1.0, .rig = {.roll = 0.2 * kDegree}}, 1);
  for (std::size_t i = 0; i < problem.landmarks.size(); i += 5)
    problem.landmarks[i].sightings.back().right.y() += 4.0;
  EXPECT_NEAR(rowEvidence(problem).errors[RowErrors::kRoll], 0.2 * kDegree, 0.02 * kDegree);
}

TEST(RowEvidence, ErrsAsItsInformationSays) {
  constexpr int kTrials = 60;
  double sum = 0.0;
  for (int i = 0; i < kTrials; ++i) {
    const RowEvidence evidence = rowEvidence(test::seenBy({.landmarks = kLandmarks, .noise = 1.0}, 1 + i));
    sum += evidence.errors.dot(evidence.information * evidence.errors) / RowErrors::kSize / kTrials;
  }
  // Half weight for what is far out makes it a little cautious; the noise comes from the rows themselves.
  EXPECT_GT(sum, 0.5);
  EXPECT_LT(sum, 2.0);
}

TEST(RowEvidence, KnowsAnglesLessWellTheFartherTheExposuresAreApart) {
  const auto information_at = [](double offset) {
    return rowEvidence(test::seenBy({.landmarks = kLandmarks, .offset = offset, .noise = 1.0}, 1))
        .information;
  };
  EXPECT_LT(information_at(0.025)(0, 0), 0.1 * information_at(0.0)(0, 0));
}

TEST(RowEvidence, TellsNothingByAFewMatches) {
  EXPECT_EQ(rowEvidence(test::seenBy({.landmarks = 20}, 1)).information, RowErrors::Matrix::Zero());
}

}  // namespace
}  // namespace cartvo
