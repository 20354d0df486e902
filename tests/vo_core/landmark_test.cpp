// Which stereo matches are believed by their rows, and how noisy positions are taken to be.
#include "vo_core/landmark.hpp"

#include <gtest/gtest.h>

namespace cartvo {
namespace {

std::vector<Landmark> matchedOff(const std::vector<double>& rows) {
  std::vector<Landmark> landmarks;
  for (const double row : rows) {
    Landmark& landmark = landmarks.emplace_back();
    landmark.sightings.push_back({.frame = 1, .stereo = true});
    landmark.row_miss = row;
  }
  return landmarks;
}

std::vector<bool> matchedAfter(std::vector<Landmark> landmarks) {
  std::vector<double> rows;
  forgetOffRows(landmarks, rows);
  std::vector<bool> matched;
  for (const Landmark& landmark : landmarks)
    matched.push_back(landmark.last().stereo);
  return matched;
}

TEST(OffRows, AreForgotten) {
  EXPECT_EQ(matchedAfter(matchedOff({0.1, -0.2, 1.2, 0.0, -0.9, 0.4, -0.1})),
            (std::vector<bool>{true, true, false, true, false, true, true}));
}

TEST(OffRows, AreOffThoseOfMostSoThatARigThatIsTurnedUpKeepsItsMatches) {
  EXPECT_EQ(matchedAfter(matchedOff({1.1, 0.8, 1.2, 1.0, 0.0})),
            (std::vector<bool>{true, true, true, true, false}));
}

TEST(OffRows, AreNoneWhereAllScatterAsThoseOfARolledRig) {
  const std::vector<double> rows{-1.6, -1.2, -0.8, -0.4, 0.0, 0.4, 0.8, 1.2, 1.6};
  EXPECT_EQ(matchedAfter(matchedOff(rows)), std::vector<bool>(rows.size(), true));
}

TEST(OffRows, OfCoarsePatchesMayBeTwiceAsFarOff) {
  std::vector<Landmark> landmarks = matchedOff({0.0, 0.0, 0.0, 0.0, 0.8, 0.8, 1.2});
  landmarks[4].level = landmarks[6].level = 1;
  EXPECT_EQ(matchedAfter(landmarks), (std::vector<bool>{true, true, true, true, true, false, false}));
}

TEST(OffRows, WithoutAMatchAreNone) {
  std::vector<Landmark> landmarks = matchedOff({0.0, 3.0});
  forgetLastStereo(landmarks);
  EXPECT_EQ(matchedAfter(landmarks), (std::vector<bool>{false, false}));
}

TEST(PatchNoise, GrowsWithWhatTheAlignmentForetellsAndWithTheLevel) {
  const Eigen::Vector2d steep = relativeNoise({0.0, 0.0}, 0);
  const Eigen::Vector2d edge = relativeNoise({0.04 * 0.04, 0.4 * 0.4}, 0);
  EXPECT_GT(steep.minCoeff(), 0.5);  // no patch is known exactly
  EXPECT_LT(edge.x(), 1.2 * steep.x());
  EXPECT_GT(edge.y(), 4.0 * steep.y());
  EXPECT_EQ(relativeNoise({0.0, 0.0}, 1), 2.0 * steep);
}

TEST(PatchNoise, IsMoreInAVideoAndLevelsTheBestPatches) {
  std::vector<Landmark> landmarks(2);
  landmarks[0].sightings.push_back({.relative_noise = relativeNoise({0.0, 0.0}, 0)});
  landmarks[1].sightings.push_back({.relative_noise = relativeNoise({0.25, 0.25}, 0)});
  doubtLastPositions(landmarks);
  const double steep = landmarks[0].last().relative_noise.x() / relativeNoise({0.0, 0.0}, 0).x();
  const double gentle = landmarks[1].last().relative_noise.x() / relativeNoise({0.25, 0.25}, 0).x();
  EXPECT_GT(steep, 1.5);
  EXPECT_GT(gentle, 1.0);
  EXPECT_LT(gentle, 1.05);
}

}  // namespace
}  // namespace cartvo
