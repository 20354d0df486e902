// Tests of the answers of one pair, on computed matches, and of what several answers say.
#include "vo_core/integrity/stereo_look.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "support/vo_core/synthetic_texture.hpp"
#include "vo_core/geometry/rig_correction.hpp"
#include "vo_core/integrity/stereo_geometry_check.hpp"

namespace cartvo::vo {
namespace {

const StereoCamera kCamera{480.0, 340.0, 210.0, 0.12, 680, 420};
constexpr PairTimes kTimes{.offset = 0.0, .flow = 0.055, .period = 0.055};

/// Properties that distinguish the matches of a scene from those of a correct rig at rest.
struct Scene {
  RigCorrection error{};
  double speed = 3.0;  // m/s, forwards
  double lag = 0.0;    // s, of the right image
  bool swapped = false;
  int mismatches = 0;    // of 100
  double nearest = 3.0;  // m
};

std::vector<LookMatch> matchesOf(const Scene& scene) {
  test::Noise noise(7);
  std::vector<LookMatch> matches;
  for (int i = 0; i < 100; ++i) {
    const double x = (noise.uniform() - 0.5) * 1.3;
    const double y = (noise.uniform() - 0.5) * 0.8;
    const double depth = scene.nearest * std::pow(10.0, noise.uniform());
    const auto pixel = [&](double right, double seconds) {
      const Eigen::Vector3d point(depth * x - right, depth * y, depth - scene.speed * seconds);
      return project(kCamera, point);
    };
    LookMatch match;
    match.left = pixel(0.0, 0.0);
    match.right = pixel(kCamera.baseline, scene.lag);
    match.row_flow = match.left.y() - pixel(0.0, -kTimes.flow).y();
    match.right += match.right - correctedRight(kCamera, scene.error, match.right);
    if (scene.swapped) std::swap(match.left, match.right);
    match.right.y() += 0.4 * (noise.uniform() - 0.5);
    if (i < scene.mismatches)
      match.right += Eigen::Vector2d(100.0 * (noise.uniform() - 0.5), 50.0 * (noise.uniform() - 0.5));
    matches.push_back(match);
  }
  return matches;
}

StereoLook look(const Scene& scene, const PairTimes& times = kTimes) {
  return lookAt(kCamera, matchesOf(scene), times);
}

TEST(StereoLook, FindsACorrectRigRight) {
  const StereoLook seen = look({});
  EXPECT_EQ(seen.rows, Evidence::right);
  EXPECT_EQ(seen.order, Evidence::right);
  EXPECT_EQ(seen.lag, Evidence::right);
}

TEST(StereoLook, IgnoresMismatches) {
  const StereoLook seen = look({.mismatches = 25});
  EXPECT_EQ(seen.rows, Evidence::right);
  EXPECT_EQ(seen.order, Evidence::right);
  EXPECT_NE(seen.lag, Evidence::wrong);
}

TEST(StereoLook, SaysNothingAboutFewMatches) {
  std::vector<LookMatch> matches = matchesOf({.swapped = true});
  matches.resize(20);
  const StereoLook seen = lookAt(kCamera, matches, kTimes);
  EXPECT_EQ(seen.rows, Evidence::none);
  EXPECT_EQ(seen.order, Evidence::none);
  EXPECT_EQ(seen.lag, Evidence::none);
}

/// Date and name in the pictures, at the same pixels of both, which rectification moves apart.
TEST(StereoLook, SaysNothingAboutLettering) {
  std::vector<LookMatch> matches;
  for (int i = 0; i < 40; ++i) {
    LookMatch match;
    match.left = {20.0 + 15.0 * i, i % 2 == 0 ? 20.0 : 400.0};
    match.right = match.left + Eigen::Vector2d(12.0, 9.0);
    match.row_flow = 0.0;
    matches.push_back(match);
  }
  const StereoLook seen = lookAt(kCamera, matches, kTimes);
  EXPECT_EQ(seen.rows, Evidence::none);
  EXPECT_EQ(seen.order, Evidence::none);
}

TEST(StereoLook, FindsExchangedImages) {
  EXPECT_EQ(look({.swapped = true}).order, Evidence::wrong);
}

TEST(StereoLook, CannotTellTheOrderOfADistantScene) {
  EXPECT_EQ(look({.swapped = true, .nearest = 100.0}).order, Evidence::none);
  EXPECT_EQ(look({.error = {.yaw = 0.01}, .nearest = 100.0}).order, Evidence::none);
  EXPECT_EQ(look({.error = {.yaw = -0.01}, .nearest = 100.0}).order, Evidence::none);
}

TEST(StereoLook, LeavesCorrectableRotationsToSelfCalibration) {
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_EQ(look({.error = {.pitch = sign * 0.0105}}).rows, Evidence::right);
    EXPECT_EQ(look({.error = {.roll = sign * 0.01}}).rows, Evidence::right);
    EXPECT_EQ(look({.error = {.yaw = sign * 0.01}}).rows, Evidence::right);
  }
}

TEST(StereoLook, FindsRotationsBeyond) {
  EXPECT_EQ(look({.error = {.pitch = 0.02}}).rows, Evidence::wrong);
  EXPECT_EQ(look({.error = {.roll = 0.02}}).rows, Evidence::wrong);
  EXPECT_EQ(look({.error = {.yaw = 0.06}}).rows, Evidence::wrong);
}

TEST(StereoLook, FindsUnrelatedRows) {
  EXPECT_EQ(look({.mismatches = 90}).rows, Evidence::wrong);
}

TEST(StereoLook, FindsALagThatTheTimestampsDoNotTell) {
  for (const double lag : {-0.055, 0.055}) {
    EXPECT_EQ(look({.lag = lag}).lag, Evidence::wrong);
    EXPECT_NE(look({.lag = lag}).rows, Evidence::wrong);
    EXPECT_EQ(look({.lag = lag}, {.offset = lag, .flow = kTimes.flow, .period = kTimes.period}).lag,
              Evidence::right);
  }
}

TEST(StereoLook, CannotTellTheLagIfTheTimestampsAreUncertain) {
  EXPECT_EQ(look({.lag = 0.055}, {.flow = 0.055, .period = 0.055, .offset_stddev = 0.01}).lag,
            Evidence::none);
}

TEST(StereoLook, CannotTellTheLagAtAStandstill) {
  EXPECT_EQ(look({.speed = 0.0, .lag = 0.055}).lag, Evidence::none);
}

TEST(GeometryQuestion, IsSuspectedAfterTwoLooksAndWrongAfterFour) {
  GeometryQuestion question;
  question.update(Evidence::wrong);
  EXPECT_FALSE(question.isSuspected());
  question.update(Evidence::wrong);
  EXPECT_TRUE(question.isSuspected());
  EXPECT_FALSE(question.isWrong());
  for (int i = 0; i < 2; ++i)
    question.update(Evidence::wrong);
  EXPECT_TRUE(question.isWrong());
  EXPECT_FALSE(question.isSuspected());
}

TEST(GeometryQuestion, IsNotSuspectedOnceItWasSeenRight) {
  GeometryQuestion question;
  question.update(Evidence::right);
  for (int i = 0; i < 3; ++i)
    question.update(Evidence::wrong);
  EXPECT_FALSE(question.isSuspected());
  EXPECT_TRUE(question.isContested());
}

TEST(GeometryQuestion, NeedsConsecutiveAnswers) {
  GeometryQuestion question;
  for (int i = 0; i < 20; ++i)
    question.update(i % 4 == 3 ? Evidence::right : Evidence::wrong);
  EXPECT_FALSE(question.isWrong());
}

TEST(GeometryQuestion, ForgetsASuspicionThatIsNotConfirmed) {
  GeometryQuestion question;
  for (int i = 0; i < 2; ++i)
    question.update(Evidence::wrong);
  for (int i = 0; i < 4; ++i)
    question.update(Evidence::none);
  EXPECT_FALSE(question.isSuspected());
}

TEST(GeometryQuestion, StaysWrongUntilSeenRight) {
  GeometryQuestion question;
  for (int i = 0; i < 4; ++i)
    question.update(Evidence::wrong);
  for (int i = 0; i < 100; ++i)
    question.update(Evidence::none);
  EXPECT_TRUE(question.isWrong());
  for (int i = 0; i < 4; ++i)
    question.update(Evidence::right);
  EXPECT_FALSE(question.isWrong());
}

}  // namespace
}  // namespace cartvo::vo
