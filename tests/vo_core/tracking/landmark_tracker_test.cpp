// Tests of the landmark tracker on a textured wall that moves sideways by known amounts.
#include "vo_core/tracking/landmark_tracker.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "common/statistics.hpp"
#include "support/vo_core/synthetic_texture.hpp"

namespace cartvo::vo {
namespace {

constexpr int kWidth = 400, kHeight = 240;
constexpr double kDisparity = 8.0;                       // px, of the wall
const Eigen::Vector2d kShift = Eigen::Vector2d(5.3, 0);  // px, of the wall from pair to pair

StereoCamera camera() {
  return {
      .focal_length = 300.0, .cx = 200.0, .cy = 120.0, .baseline = 0.12, .width = kWidth, .height = kHeight};
}
double wallDepth() {
  return camera().focal_length * camera().baseline / kDisparity;
}

/// The rectified right camera from the left one.
Eigen::Isometry3d rightFromLeft() {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation().x() = -camera().baseline;
  return T;
}

template <typename Texture = test::WaveTexture>
cv::Mat wallAt(const Eigen::Vector2d& shift) {
  static const Texture texture(11);
  return test::draw(kWidth, kHeight,
                    [&](double x, double y) { return texture(x - shift.x(), y - shift.y()); });
}

template <typename Texture = test::WaveTexture>
WindowFrame frameAt(int index) {
  WindowFrame frame;
  frame.index = index;
  frame.left = PyramidPool(4).build(wallAt<Texture>(index * kShift));
  // A wall that moves to the right corresponds to a camera that moves to the left.
  frame.T_world_camera.translation().x() = -index * kShift.x() * wallDepth() / camera().focal_length;
  return frame;
}

class LandmarkTrackerTest : public testing::Test {
 protected:
  LandmarkTrackerTest() {
    window_.push_back(frameAt(0));
    tracker_.replenish(landmarks_, *window_.front().left, 0);
  }

  void track(int index, std::int64_t oldest_anchor, const std::optional<Eigen::Isometry3d>& expected) {
    const WindowFrame frame = frameAt(index);
    const std::vector<Landmark> previous = landmarks_;
    tracker_.track(previous, landmarks_, {window_, *frame.left, index, oldest_anchor, expected});
    window_.push_back(frame);
  }

  /// Median distance of the landmarks' last positions from the anchor positions moved with the wall, px.
  double medianError() const {
    std::vector<double> errors;
    for (const Landmark& landmark : landmarks_) {
      const auto pairs = static_cast<double>(landmark.last().frame - landmark.anchor().frame);
      errors.push_back((landmark.last().left - landmark.anchor().left - pairs * kShift).norm());
    }
    return errors.empty() ? INFINITY : median(errors);
  }

  OdometrySettings settings_ = [] {
    OdometrySettings s;
    s.features = 150;
    return s;
  }();
  LandmarkTracker tracker_{camera(), settings_};
  std::vector<WindowFrame> window_;
  std::vector<Landmark> landmarks_;
};

TEST_F(LandmarkTrackerTest, TracksWithoutPredictedPose) {
  const std::size_t before = landmarks_.size();
  ASSERT_GT(before, 50U);
  for (int index = 1; index <= 3; ++index)
    track(index, 0, std::nullopt);
  EXPECT_GT(landmarks_.size(), 0.8 * static_cast<double>(before));  // the others have left the image
  EXPECT_LT(medianError(), 0.03);
  std::size_t of_first_anchor = 0;  // the others changed their anchor
  for (const Landmark& landmark : landmarks_) {
    if (landmark.observations.size() == 4U) ++of_first_anchor;
    EXPECT_EQ(landmark.age, 4);
  }
  EXPECT_GT(of_first_anchor, 0.95 * static_cast<double>(landmarks_.size()));
}

TEST_F(LandmarkTrackerTest, FindsLandmarksOfUnknownDepthAwayFromThePrediction) {
  const std::size_t before = landmarks_.size();
  track(1, 0, Eigen::Isometry3d::Identity());  // the wall has moved on by 5 px
  EXPECT_GT(landmarks_.size(), 0.8 * static_cast<double>(before));
  EXPECT_LT(medianError(), 0.1);
}

TEST_F(LandmarkTrackerTest, FindsLandmarksWhereverThePredictionIsWrong) {
  using Texture =
      test::MultiscaleTexture;  // the whole image shows the motion only if it has coarse structure
  window_ = {frameAt<Texture>(0)};
  landmarks_.clear();
  LandmarkTracker tracker(camera(), settings_);
  tracker.replenish(landmarks_, *window_.front().left, 0);
  for (const int pairs : {4, 8, 11}) {  // the wall has moved on by 21, 42 and 58 px
    std::vector<Landmark> tracked;
    const WindowFrame frame = frameAt<Texture>(pairs);
    const TrackingOutcome outcome =
        tracker.track(landmarks_, tracked, {window_, *frame.left, pairs, 0, Eigen::Isometry3d::Identity()});
    const double visible = (kWidth - pairs * kShift.x()) / kWidth;
    EXPECT_GT(tracked.size(), 0.8 * visible * static_cast<double>(landmarks_.size())) << pairs;
    std::vector<double> errors;
    for (const Landmark& landmark : tracked)
      errors.push_back((landmark.last().left - landmark.anchor().left - pairs * kShift).norm());
    EXPECT_LT(medianOf(errors), 0.1) << pairs;
    // The corrected prediction turns the camera by the shift of the image.
    EXPECT_TRUE(outcome.prediction_failed) << pairs;
    EXPECT_NEAR(vectorFromMotion(outcome.T_world_camera.value())[4],
                -pairs * kShift.x() / camera().focal_length, 0.02)
        << pairs;
  }
}

TEST_F(LandmarkTrackerTest, TracksAndMatchesCoarseLandmarks) {
  const ImagePyramid left = buildPyramid(wallAt(Eigen::Vector2d::Zero()), 4);
  const ImagePyramid right = buildPyramid(wallAt({-kDisparity, 0.0}), kLandmarkLevels);
  for (Landmark& landmark : landmarks_)
    landmark.level = 1;
  tracker_.matchStereo(landmarks_, window_, left, right, RowTransform(rightFromLeft()),
                       Eigen::Isometry3d::Identity());
  test::Statistics disparity;
  for (const Landmark& landmark : landmarks_)
    if (landmark.last().stereo) disparity.add(landmark.last().stereo_offset.x());
  EXPECT_GT(disparity.count(), 0.5 * static_cast<double>(landmarks_.size()));
  EXPECT_NEAR(disparity.mean(), kDisparity, 0.04);
  EXPECT_LT(disparity.stddev(), 0.2);
  for (int index = 1; index <= 3; ++index)
    track(index, 0, std::nullopt);
  EXPECT_GT(landmarks_.size(), 40U);
  EXPECT_LT(medianError(), 0.06);
}

TEST_F(LandmarkTrackerTest, ReplacesAnOldAnchorAndKeepsTheDepth) {
  const double inverse_depth = 1.0 / wallDepth();
  constexpr double kInformation = 1e4;  // m^2
  for (Landmark& landmark : landmarks_) {
    landmark.inverse_depth = inverse_depth;
    landmark.information = kInformation;
  }
  track(1, 0, frameAt(1).T_world_camera);
  track(2, 1, frameAt(2).T_world_camera);  // index 0 is too old for an anchor
  ASSERT_FALSE(landmarks_.empty());
  for (const Landmark& landmark : landmarks_) {
    EXPECT_EQ(landmark.anchor().frame, 1);
    EXPECT_EQ(landmark.observations.size(), 2U);
    EXPECT_NEAR(landmark.inverse_depth, inverse_depth, 1e-9);  // the camera has moved along the wall
    EXPECT_NEAR(landmark.information, kInformation, 1e-6);
  }
  EXPECT_LT(medianError(), 0.03);
}

TEST_F(LandmarkTrackerTest, MatchesLandmarksWithAndWithoutDepthInTheRightImage) {
  const ImagePyramid left = buildPyramid(wallAt(Eigen::Vector2d::Zero()), 4);
  const ImagePyramid right = buildPyramid(wallAt({-kDisparity, 0.0}), 1);
  for (std::size_t i = 0; i < landmarks_.size(); i += 2) {
    landmarks_[i].inverse_depth = 1.0 / wallDepth();
    landmarks_[i].information = 1e4;
  }
  tracker_.matchStereo(landmarks_, window_, left, right, RowTransform(rightFromLeft()),
                       Eigen::Isometry3d::Identity());
  for (const bool known : {true, false}) {
    test::Statistics disparity;
    int candidates = 0;
    for (std::size_t i = 0; i < landmarks_.size(); ++i) {
      if ((i % 2 == 0) != known) continue;
      ++candidates;
      if (landmarks_[i].last().stereo) disparity.add(landmarks_[i].last().stereo_offset.x());
    }
    EXPECT_GT(disparity.count(), 0.6 * candidates) << known;
    EXPECT_NEAR(disparity.mean(), kDisparity, 0.02) << known;
    EXPECT_LT(disparity.stddev(), 0.1) << known;
  }
}

// A right camera that has moved forward since the left exposure: patches are larger, in rows too.
TEST_F(LandmarkTrackerTest, MatchesRightCameraCloserToTheWall) {
  constexpr double kGrowth = 1.06;
  const StereoCamera rig = camera();
  const auto seen_by_right = [&](const Eigen::Vector2d& left) -> Eigen::Vector2d {
    return {rig.cx + kGrowth * (left.x() - kDisparity - rig.cx), rig.cy + kGrowth * (left.y() - rig.cy)};
  };
  const test::WaveTexture texture(11);  // wallAt's
  const ImagePyramid left = buildPyramid(wallAt(Eigen::Vector2d::Zero()), 4);
  const ImagePyramid right =
      buildPyramid(test::draw(kWidth, kHeight,
                              [&](double x, double y) {
                                return texture((x - rig.cx) / kGrowth + rig.cx + kDisparity,
                                               (y - rig.cy) / kGrowth + rig.cy);
                              }),
                   1);
  for (Landmark& landmark : landmarks_) {
    landmark.inverse_depth = 1.0 / wallDepth();
    landmark.information = 1e4;
  }
  Eigen::Isometry3d T_right_left = rightFromLeft();
  T_right_left.translation().z() = wallDepth() * (1.0 / kGrowth - 1.0);
  tracker_.matchStereo(landmarks_, window_, left, right, RowTransform(T_right_left),
                       Eigen::Isometry3d::Identity());
  std::vector<double> errors;
  for (const Landmark& landmark : landmarks_)
    if (const Observation& last = landmark.last(); last.stereo)
      errors.push_back((last.left - last.stereo_offset - seen_by_right(last.left)).norm());
  ASSERT_GT(errors.size(), 0.6 * static_cast<double>(landmarks_.size()));
  EXPECT_LT(median(errors), 0.02);  // px
}

TEST_F(LandmarkTrackerTest, KeepsTheMoreTrustedOfTwoCloseLandmarks) {
  ASSERT_FALSE(landmarks_.empty());
  Landmark close = landmarks_.front();
  close.observations.front().left += Eigen::Vector2d(1.0, 1.0);
  close.weight = 0.5;
  const Eigen::Vector2d position = close.last().left;
  landmarks_.push_back(close);
  tracker_.replenish(landmarks_, *window_.front().left, 0);
  EXPECT_TRUE(std::none_of(landmarks_.begin(), landmarks_.end(),
                           [&](const Landmark& landmark) { return landmark.last().left == position; }));
}

}  // namespace
}  // namespace cartvo::vo
