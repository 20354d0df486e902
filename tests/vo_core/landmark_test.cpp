// Which stereo matches are believed by their rows.
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

}  // namespace
}  // namespace cartvo
