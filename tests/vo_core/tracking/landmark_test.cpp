// Tests of the noise of positions.
#include "vo_core/tracking/landmark.hpp"

#include <gtest/gtest.h>

namespace cartvo::vo {
namespace {

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
