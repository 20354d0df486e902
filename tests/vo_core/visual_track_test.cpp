// Tests of a single track: accepted and rejected pairs, standstill, rig calibration.
#include "vo_core/track/visual_track.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "support/vo_core/corridor_world.hpp"

namespace cartvo::vo {
namespace {

const StereoCamera kCamera{260.0, 208.0, 112.0, 0.2, 416, 224};
constexpr std::int64_t kPeriod = 50'000'000;  // ns
constexpr double kStep = 0.15;                // m from pair to pair

Eigen::Isometry3d drive(double frame) {
  Vector6d vector = Vector6d::Zero();
  vector[2] = kStep * frame;
  vector[4] = 0.006 * frame;
  return motionFromVector(vector);
}

/// The first pairs of the drive, rendered once.
const StereoImages& drivePair(int frame) {
  static const std::vector<StereoImages> pairs = [] {
    std::vector<StereoImages> rendered;
    const test::CorridorWorld world(3);
    for (int i = 0; i < 8; ++i)
      rendered.push_back(world.render(kCamera, drive(i), 0));
    return rendered;
  }();
  return pairs[frame];
}

PreparedPair prepared(const StereoImages& images, int index) {
  PreparedPair pair;
  pair.index = index;
  pair.left_exposure_ns = pair.right_exposure_ns = index * kPeriod;
  pair.left = PyramidPool(OdometrySettings{}.tracking.levels).build(images.left);
  pair.right = PyramidPool(1).build(images.right);
  return pair;
}

/// Images with a wall half a metre away in front of a third of them.
StereoImages partlyHidden(const StereoImages& images) {
  StereoImages hidden{images.left.clone(), images.right.clone(), 0, 0};
  hidden.left(cv::Rect(288, 0, 128, 224)) = 90;
  hidden.right(cv::Rect(188, 0, 128, 224)) = 90;
  return hidden;
}

/// Images whose columns from `from` on are those of another pair.
StereoImages beside(const StereoImages& images, const StereoImages& other, int from) {
  StereoImages both{images.left.clone(), images.right.clone(), 0, 0};
  const cv::Rect part(from, 0, kCamera.width - from, kCamera.height);
  other.left(part).copyTo(both.left(part));
  other.right(part).copyTo(both.right(part));
  return both;
}

OdometrySettings smallSettings() {
  OdometrySettings settings;
  settings.features = 400;
  return settings;
}

ReadoutEstimates readoutsOf(const StereoShutters& shutters) {
  return {{shutters.left.readout, shutters.left.readout_stddev},
          {shutters.right.readout, shutters.right.readout_stddev}};
}

class VisualTrackTest : public testing::Test {
 protected:
  VisualTrack begin(const OdometrySettings& settings = smallSettings(), const StereoShutters& shutters = {}) {
    return VisualTrack(kCamera, settings, RowTiming(kCamera, shutters), prepared(drivePair(0), 0),
                       {RigCalibration(), readoutsOf(shutters), StillRegions(kCamera)}, reinitialiser_,
                       observer_);
  }
  TrackedMotion show(VisualTrack& track, const StereoImages& images, int index) {
    return track.process(prepared(images, index), observer_);
  }
  /// Repeats the first pair until the track detects a standstill; returns the next index.
  int stop(VisualTrack& track) {
    int index = 1;
    while (index < 20 && show(track, drivePair(0), index).reason != OdometryReason::zero_velocity)
      ++index;
    return index + 1;
  }

  PitchReinitialiser reinitialiser_{kCamera, {}, TrackingSettings{}.levels};
  NullStageObserver observer_;
};

TEST_F(VisualTrackTest, StartsAtTheOriginWithZeroCovariance) {
  const VisualTrack track = begin();
  EXPECT_EQ(track.pose().matrix(), Eigen::Matrix4d::Identity());
  EXPECT_EQ(track.poseCovariance(), Matrix6d::Zero());
  EXPECT_EQ(track.lastExposure(), 0);
  EXPECT_GT(track.landmarkCount(), 100);
}

TEST_F(VisualTrackTest, ErrorsAgreeWithItsCovariances) {
  VisualTrack track = begin();
  constexpr double kFarOut = 30.0;  // chi-square of six degrees of freedom: beyond it once in 25,000 cases
  double pose_variance = 0.0;
  for (int i = 1; i < 7; ++i) {
    const TrackedMotion motion = show(track, drivePair(i), i);
    ASSERT_TRUE(motion.valid()) << i;
    const Eigen::Isometry3d truth = drive(i - 1).inverse() * drive(i);
    const Vector6d error = vectorFromMotion(motion.T_previous_current.inverse() * truth);
    EXPECT_LT(error.dot(motion.covariance().ldlt().solve(error)), kFarOut) << i;
    EXPECT_LT(error.head<3>().norm(), 0.05 * kStep) << i;
    const Vector6d pose_error = vectorFromMotion(motion.T_world_camera.inverse() * drive(i));
    EXPECT_LT(pose_error.dot(track.poseCovariance().ldlt().solve(pose_error)), kFarOut) << i;
    // It grows overall, but a pair also corrects the previous pose, which may outweigh a single step.
    EXPECT_GT(track.poseCovariance().trace(), 0.9 * pose_variance);
    pose_variance = track.poseCovariance().trace();
  }
}

TEST_F(VisualTrackTest, PoseNoiseInflationScalesCovariancesOnly) {
  VisualTrack images = begin(), video = begin();
  for (int i = 1; i < 6; ++i)
    for (VisualTrack* const track : {&images, &video})
      ASSERT_TRUE(show(*track, drivePair(i), i).valid()) << i;
  PreparedPair pair = prepared(drivePair(6), 6);
  const TrackedMotion alone = images.process(pair, observer_);
  pair.pose_noise_inflation = 4.0;
  const TrackedMotion shared = video.process(pair, observer_);
  EXPECT_EQ(shared.T_world_camera.matrix(), alone.T_world_camera.matrix());
  EXPECT_EQ(shared.stddevByWindow(), alone.stddevByWindow());
  EXPECT_TRUE(shared.covariance().isApprox(4.0 * alone.covariance(), 1e-9));
  EXPECT_GT(video.poseCovariance().trace(), images.poseCovariance().trace());
}

TEST_F(VisualTrackTest, PoseNoiseInflationKeepsAMotionValid) {
  VisualTrack track = begin();
  PreparedPair pair = prepared(drivePair(1), 1);
  pair.pose_noise_inflation = 1e8;
  const TrackedMotion motion = track.process(pair, observer_);
  EXPECT_TRUE(motion.valid());
  EXPECT_GT(motion.covariance()(2, 2), 1.0);
}

TEST_F(VisualTrackTest, InvalidMotionLeavesTheTrackUnchanged) {
  VisualTrack track = begin();
  show(track, drivePair(1), 1);
  const Eigen::Isometry3d pose = track.pose();
  const int landmarks = track.landmarkCount();
  const cv::Mat grey(kCamera.height, kCamera.width, CV_8UC1, cv::Scalar(100));
  const TrackedMotion blind = show(track, {grey, grey, 0, 0}, 2);
  EXPECT_FALSE(blind.valid());
  EXPECT_EQ(blind.reason, OdometryReason::too_few_matches);
  EXPECT_EQ(track.pose().matrix(), pose.matrix());
  EXPECT_EQ(track.landmarkCount(), landmarks);
  EXPECT_EQ(track.lastExposure(), kPeriod);
  const TrackedMotion after = show(track, drivePair(3), 3);
  ASSERT_TRUE(after.valid());
  EXPECT_NEAR(after.time_step, 0.1, 1e-9);
  EXPECT_NEAR(after.T_previous_current.translation().norm(), 2.0 * kStep, 0.02 * kStep);
}

TEST_F(VisualTrackTest, NamesTheReasonOfAnInvalidMotion) {
  OdometrySettings slow = smallSettings();
  slow.validity.maximum_speed = 0.5 * kStep / 0.05;
  OdometrySettings strict = smallSettings();
  // m/s^2: the motion between two pairs that it allows is below the standard deviation of any pair here.
  strict.pose_search.maximum_acceleration = 0.04;
  for (const auto& [settings, reason] : {std::pair(slow, OdometryReason::implausible_motion),
                                         std::pair(strict, OdometryReason::degenerate_geometry)}) {
    VisualTrack track = begin(settings);
    const TrackedMotion motion = show(track, drivePair(1), 1);
    EXPECT_EQ(motion.reason, reason);
    EXPECT_EQ(track.pose().matrix(), Eigen::Matrix4d::Identity());
    EXPECT_EQ(track.lastExposure(), 0);
  }
}

/// An implausible motion is only known to be one when all else has been estimated.
TEST_F(VisualTrackTest, ImplausibleMotionLeavesTheEstimatesUnchanged) {
  StereoShutters shutters;
  for (Shutter* shutter : {&shutters.left, &shutters.right})
    *shutter = {.readout = 0.03, .readout_stddev = 0.005, .rows = {}};
  OdometrySettings settings = smallSettings();
  settings.validity.maximum_speed = 1.5 * kStep / 0.05;
  VisualTrack track = begin(settings, shutters);
  for (int i = 1; i < 6; ++i)
    ASSERT_TRUE(show(track, drivePair(i), i).valid()) << i;
  const auto readout = [&] { return track.readouts().value().left; };
  const auto pitch = [&] { return track.rigCalibrationError().value().pitch; };
  const EstimateWithStddev readout_before = readout(), pitch_before = pitch();
  ASSERT_EQ(show(track, drivePair(7), 6).reason, OdometryReason::implausible_motion);
  EXPECT_EQ(readout().value, readout_before.value);
  EXPECT_EQ(readout().stddev, readout_before.stddev);
  EXPECT_EQ(pitch().value, pitch_before.value);
  EXPECT_EQ(pitch().stddev, pitch_before.stddev);
  ASSERT_TRUE(show(track, drivePair(7), 7).valid());
  EXPECT_NE(readout().value, readout_before.value);
  EXPECT_NE(pitch().value, pitch_before.value);
}

/// Half of the image moves as if the cart drove, half as if it stood, as beside a bus.
TEST_F(VisualTrackTest, RejectsAnAmbiguousFirstMotion) {
  VisualTrack track = begin();
  const TrackedMotion motion = show(track, beside(drivePair(0), drivePair(1), kCamera.width / 2), 1);
  EXPECT_TRUE(motion.evidence.ambiguous);
  EXPECT_EQ(motion.reason, OdometryReason::too_few_inliers);
  EXPECT_EQ(track.pose().matrix(), Eigen::Matrix4d::Identity());
}

TEST_F(VisualTrackTest, FirstMotionIsNotAmbiguousWithASmallMovingPart) {
  VisualTrack track = begin();
  const TrackedMotion motion = show(track, beside(drivePair(1), drivePair(0), kCamera.width * 3 / 4), 1);
  EXPECT_FALSE(motion.evidence.ambiguous);
  ASSERT_TRUE(motion.valid());
  EXPECT_NEAR(motion.T_previous_current.translation().z(), kStep, 0.05 * kStep);
}

/// Two fifths of the image move in two other ways, neither of which has half of the weight of the first one.
TEST_F(VisualTrackTest, FirstMotionIsUncertainBesideTwoOtherOnes) {
  VisualTrack track = begin();
  const StereoImages stands = beside(drivePair(1), drivePair(0), kCamera.width * 3 / 5);
  const TrackedMotion motion = show(track, beside(stands, drivePair(3), kCamera.width * 4 / 5), 1);
  EXPECT_FALSE(motion.evidence.ambiguous);
  ASSERT_TRUE(motion.valid());
  EXPECT_NEAR(motion.T_previous_current.translation().z(), kStep, 0.05 * kStep);
  EXPECT_GT(std::sqrt(motion.twist->covariance(2, 2)), 1.0);  // m/s
}

/// The cart drives behind a vehicle that fills three quarters of the view: a motion of most landmarks, which
/// stand still in the image. It has no small bound, and the next pairs do not make it one.
TEST_F(VisualTrackTest, IsUncertainAmongVehiclesThatFillTheView) {
  VisualTrack track = begin();
  for (int i = 1; i < 4; ++i) {
    const StereoImages images = beside(drivePair(0), drivePair(i), kCamera.width * 3 / 4);
    const TrackedMotion motion = show(track, images, i);
    if (!motion.valid()) continue;
    EXPECT_GT(std::sqrt(motion.twist->covariance(2, 2)), 1.0) << i;  // m/s
    EXPECT_GT(std::sqrt(motion.covariance()(2, 2)), 1.0 * motion.time_step) << i;
  }
  EXPECT_FALSE(track.isEstablished());
}

TEST_F(VisualTrackTest, IsEstablishedByPairsThatAgree) {
  VisualTrack track = begin();
  TrackedMotion motion;
  for (int i = 1; i < 6; ++i)
    motion = show(track, drivePair(i), i);
  EXPECT_TRUE(track.isEstablished());
  EXPECT_LT(std::sqrt(motion.twist->covariance(2, 2)), 0.5);
}

TEST_F(VisualTrackTest, IsEstablishedByAStandstill) {
  VisualTrack track = begin();
  stop(track);
  EXPECT_TRUE(track.isEstablished());
}

/// With a velocity prior another motion in half of the image does not make the motion ambiguous.
TEST_F(VisualTrackTest, LaterMotionIsNotAmbiguous) {
  VisualTrack track = begin();
  for (int i = 1; i < 4; ++i)
    ASSERT_TRUE(show(track, drivePair(i), i).valid()) << i;
  const TrackedMotion motion = show(track, beside(drivePair(4), drivePair(3), kCamera.width / 2), 4);
  EXPECT_FALSE(motion.evidence.ambiguous);
  ASSERT_TRUE(motion.valid());
  EXPECT_NEAR(motion.T_previous_current.translation().z(), kStep, 0.05 * kStep);
}

/// A part of the cart in the view fits a standstill exactly, whatever the rest of the image shows.
TEST_F(VisualTrackTest, PartOfTheCartInViewHidesNoMotion) {
  VisualTrack track = begin();
  const int index = stop(track);
  const TrackedMotion motion = show(track, beside(drivePair(1), drivePair(0), kCamera.width * 3 / 5), index);
  EXPECT_EQ(motion.reason, OdometryReason::too_few_inliers);
}

TEST_F(VisualTrackTest, StandstillHoldsBesideAVehicle) {
  VisualTrack track = begin();
  const int start = stop(track);
  for (int i = 1; i < 8; ++i) {
    const StereoImages images = beside(drivePair(0), drivePair(i), kCamera.width * 3 / 5);
    EXPECT_EQ(show(track, images, start + i).reason, OdometryReason::zero_velocity) << i;
  }
}

/// The cart cannot accelerate by 180 m/s^2, but all landmarks, near and far, left and right, say so.
TEST_F(VisualTrackTest, AcceptsAnImplausibleMotionThatTheWholeImageShows) {
  VisualTrack track = begin();
  for (int i = 1; i < 4; ++i)
    ASSERT_TRUE(show(track, drivePair(i), i).valid()) << i;
  const TrackedMotion motion = show(track, drivePair(6), 4);
  ASSERT_TRUE(motion.valid());
  EXPECT_NEAR(motion.T_previous_current.translation().z(), 3.0 * kStep, 0.05 * kStep);
}

TEST_F(VisualTrackTest, KeepsThePoseExactlyDuringAStandstill) {
  VisualTrack track = begin();
  const int index = stop(track);
  EXPECT_LE(index, 8);  // 0.25 s and a pair
  const Eigen::Isometry3d pose = track.pose();
  const Matrix6d covariance = track.poseCovariance();
  for (int i = index; i < index + 10; ++i) {
    const TrackedMotion motion = show(track, drivePair(0), i);
    ASSERT_EQ(motion.reason, OdometryReason::zero_velocity);
    EXPECT_EQ(motion.T_previous_current.matrix(), Eigen::Matrix4d::Identity());
    EXPECT_GT(motion.covariance().diagonal().minCoeff(), 0.0) << "a standstill is not exact";
    EXPECT_NEAR(motion.time_step, 0.05, 1e-9);
  }
  EXPECT_EQ(track.pose().matrix(), pose.matrix());
  EXPECT_EQ(track.poseCovariance(), covariance);
}

TEST_F(VisualTrackTest, StandstillEndsWithTheFirstMotion) {
  VisualTrack track = begin();
  int index = stop(track);
  const test::CorridorWorld world(3);
  double before = 0.0;
  for (const double place : {0.1, 0.3, 0.6}) {  // 6 m/s^2
    const TrackedMotion motion = show(track, world.render(kCamera, drive(place), 0), index++);
    ASSERT_EQ(motion.reason, OdometryReason::none) << place;
    EXPECT_NEAR(motion.T_previous_current.translation().z(), (place - before) * kStep, 0.001) << place;
    // The pose of a standstill is known to within its limits.
    const Matrix6d limits = StandstillDetector(StandstillSettings{}).covariance();
    EXPECT_EQ(motion.covariance()(3, 3) > limits(3, 3), before == 0.0);
    before = place;
  }
}

/// The cart is held at the pose of the standstill until a motion is valid.
TEST_F(VisualTrackTest, InvalidMotionDoesNotEndAStandstill) {
  OdometrySettings settings = smallSettings();
  settings.validity.maximum_speed = 0.5 * kStep / 0.05;
  VisualTrack track = begin(settings);
  int index = stop(track);
  ASSERT_EQ(show(track, drivePair(1), index++).reason, OdometryReason::implausible_motion);
  const TrackedMotion motion = show(track, test::CorridorWorld(3).render(kCamera, drive(0.3), 0), index++);
  ASSERT_EQ(motion.reason, OdometryReason::none);
  EXPECT_GT(motion.covariance()(3, 3), StandstillDetector(StandstillSettings{}).covariance()(3, 3));
}

TEST_F(VisualTrackTest, KeepsHiddenLandmarksDuringAStandstill) {
  VisualTrack track = begin();
  int index = stop(track);
  const int matched = show(track, drivePair(0), index++).counts.matched;
  const StereoImages hidden = partlyHidden(drivePair(0));
  for (int i = 0; i < 5; ++i) {
    const TrackedMotion motion = show(track, hidden, index++);
    EXPECT_EQ(motion.reason, OdometryReason::zero_velocity);
    EXPECT_LT(motion.counts.matched, 0.8 * matched);
  }
  EXPECT_EQ(show(track, drivePair(0), index).counts.matched, matched);
}

TEST_F(VisualTrackTest, StartsWithTheGivenRigCalibration) {
  RigCalibration known;
  known.reinitialisePitch({1e-3, 3e-3});
  const auto pitch_of = [](const VisualTrack& track) {
    return track.rigCalibrationError().value().pitch.value;
  };
  const VisualTrack track(kCamera, smallSettings(), RowTiming(kCamera, {}), prepared(drivePair(0), 0),
                          {known, {}, StillRegions(kCamera)}, reinitialiser_, observer_);
  EXPECT_EQ(pitch_of(track), 1e-3);
  VisualTrack driven = begin();
  for (int i = 1; i < 7; ++i)
    show(driven, drivePair(i), i);
  const VisualTrack next_track(kCamera, smallSettings(), RowTiming(kCamera, {}), prepared(drivePair(6), 6),
                               driven.learnt(), reinitialiser_, observer_);
  EXPECT_NE(pitch_of(driven), 0.0);
  EXPECT_EQ(pitch_of(next_track), pitch_of(driven));
}

TEST_F(VisualTrackTest, HasNoRigCalibrationErrorWithoutRigRefinement) {
  OdometrySettings settings = smallSettings();
  settings.rig_refinement = RigRefinement::off;
  VisualTrack track = begin(settings);
  for (int i = 1; i < 7; ++i)
    show(track, drivePair(i), i);
  EXPECT_FALSE(track.rigCalibrationError().has_value());
}

}  // namespace
}  // namespace cartvo::vo
