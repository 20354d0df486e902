// Tests of the rejection of stereo matches by their rows and of the noise of positions.
#include "vo_core/tracking/landmark.hpp"

#include <gtest/gtest.h>

namespace cartvo::vo {
namespace {

std::vector<Landmark> withRowResiduals(const std::vector<double>& rows) {
  std::vector<Landmark> landmarks;
  for (const double row : rows) {
    Landmark& landmark = landmarks.emplace_back();
    landmark.observations.push_back({.frame = 1, .stereo = true});
    landmark.row_residual = row;
  }
  return landmarks;
}

std::vector<bool> matchesAfterRejection(std::vector<Landmark> landmarks) {
  std::vector<double> rows;
  rejectRowOutliers(landmarks, {}, rows);
  std::vector<bool> matched;
  for (const Landmark& landmark : landmarks)
    matched.push_back(landmark.last().stereo);
  return matched;
}

TEST(RejectRowOutliers, RemovesMatchesFarFromTheMedianRow) {
  EXPECT_EQ(matchesAfterRejection(withRowResiduals({0.1, -0.2, 1.2, 0.0, -0.9, 0.4, -0.1})),
            (std::vector<bool>{true, true, false, true, false, true, true}));
}

TEST(RejectRowOutliers, KeepsMatchesOfARigWithPitchError) {
  EXPECT_EQ(matchesAfterRejection(withRowResiduals({1.1, 0.8, 1.2, 1.0, 0.0})),
            (std::vector<bool>{true, true, true, true, false}));
}

TEST(RejectRowOutliers, KeepsMatchesOfARolledRig) {
  const std::vector<double> rows{-1.6, -1.2, -0.8, -0.4, 0.0, 0.4, 0.8, 1.2, 1.6};
  EXPECT_EQ(matchesAfterRejection(withRowResiduals(rows)), std::vector<bool>(rows.size(), true));
}

TEST(RejectRowOutliers, DoublesTheGateForCoarsePatches) {
  std::vector<Landmark> landmarks = withRowResiduals({0.0, 0.0, 0.0, 0.0, 0.8, 0.8, 1.2});
  landmarks[4].level = landmarks[6].level = 1;
  EXPECT_EQ(matchesAfterRejection(landmarks),
            (std::vector<bool>{true, true, true, true, true, false, false}));
}

TEST(RejectRowOutliers, IgnoresLandmarksWithoutMatch) {
  std::vector<Landmark> landmarks = withRowResiduals({0.0, 3.0});
  discardLastStereo(landmarks);
  EXPECT_EQ(matchesAfterRejection(landmarks), (std::vector<bool>{false, false}));
}

TEST(PatchNoise, GrowsWithAlignmentVarianceAndLevel) {
  const Eigen::Vector2d steep = relativeNoise({0.0, 0.0}, 0, {});
  const Eigen::Vector2d edge = relativeNoise({0.04 * 0.04, 0.4 * 0.4}, 0, {});
  EXPECT_GT(steep.minCoeff(), 0.5);  // no patch has an exact position
  EXPECT_LT(edge.x(), 1.2 * steep.x());
  EXPECT_GT(edge.y(), 4.0 * steep.y());
  EXPECT_EQ(relativeNoise({0.0, 0.0}, 1, {}), 2.0 * steep);
}

TEST(PatchNoise, IsInflatedForInterCodedPicturesMostForSteepPatches) {
  std::vector<Landmark> landmarks(2);
  landmarks[0].observations.push_back({.relative_noise = relativeNoise({0.0, 0.0}, 0, {})});
  landmarks[1].observations.push_back({.relative_noise = relativeNoise({0.25, 0.25}, 0, {})});
  inflateCodecNoise(landmarks, {});
  const double steep = landmarks[0].last().relative_noise.x() / relativeNoise({0.0, 0.0}, 0, {}).x();
  const double soft = landmarks[1].last().relative_noise.x() / relativeNoise({0.25, 0.25}, 0, {}).x();
  EXPECT_GT(steep, 1.5);
  EXPECT_GT(soft, 1.0);
  EXPECT_LT(soft, 1.05);
}

}  // namespace
}  // namespace cartvo::vo
