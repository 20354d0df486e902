// Tests of the search for a lost pitch, on rendered images of a turned right camera.
#include "vo_core/self_calibration/pitch_reinitialiser.hpp"

#include <cmath>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "support/vo_core/corridor_world.hpp"
#include "support/vo_core/night.hpp"
#include "vo_core/fixed_constants.hpp"

namespace cartvo::vo {
namespace {

constexpr StereoCamera kCamera{300.0, 208.0, 112.0, 0.115, 416, 224};
constexpr int kInterval = pitch_search::kSearchInterval;
constexpr double kDegree = M_PI / 180.0;

cv::Mat leftView() {
  return test::CorridorWorld(3).view(kCamera, Eigen::Isometry3d::Identity());
}

/// View of the right camera, turned up by `pitch` (rad).
cv::Mat rightView(double pitch, std::uint64_t seed = 3) {
  Eigen::Isometry3d right(Eigen::Translation3d(kCamera.baseline, 0.0, 0.0));
  right.rotate(Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitX()));
  return test::CorridorWorld(seed).view(kCamera, right);
}

/// One pair whose landmarks have no stereo match, but for a share of them.
class Search {
 public:
  /// The pitch that is found in pair `index` (rad).
  std::optional<double> find(PitchReinitialiser& reinitialiser, const cv::Mat& left, const cv::Mat& right,
                             int index = 0) {
    const int levels = TrackingSettings{}.levels;
    const ImagePyramid left_pyramid = buildPyramid(left, levels), right_pyramid = buildPyramid(right, levels);
    window_.back().index = index;
    RigCalibration rig = rig_;
    const bool found = reinitialiser.tryReinitialise(
        {tracker_, kCamera, timing_, left_pyramid, right_pyramid, window_}, T_right_left_, landmarks_, rig);
    if (!found) {
      EXPECT_EQ(rig.error().pitch.value, rig_.error().pitch.value);
      EXPECT_EQ(rig.error().yaw.stddev, rig_.error().yaw.stddev);
      return std::nullopt;
    }
    stddev_ = rig.error().pitch.stddev;
    return rig.error().pitch.value;
  }
  std::optional<double> find(const cv::Mat& left, const cv::Mat& right) {
    PitchReinitialiser reinitialiser(kCamera, {}, TrackingSettings{}.levels);
    return find(reinitialiser, left, right);
  }
  void match(int landmarks) {
    for (int i = 0; i < landmarks; ++i)
      landmarks_[i].observations.back().stereo = true;
  }
  void know(double pitch) { rig_.reinitialisePitch({pitch, 1e-4}); }
  void delay(double offset) { window_.back().offset = offset; }
  double stddev() const { return stddev_; }  ///< of the pitch that was found
  void turnBetweenExposures(double pitch) {
    T_right_left_.rotate(Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitX()));
  }

 private:
  LandmarkTracker tracker_{kCamera, {}};
  RowTiming timing_{kCamera, {}};
  std::vector<WindowFrame> window_{1};
  std::vector<Landmark> landmarks_ = [] {
    std::vector<Landmark> landmarks(100);
    for (Landmark& landmark : landmarks)
      landmark.observations.resize(1);
    return landmarks;
  }();
  RigCalibration rig_;
  double stddev_ = 0.0;
  Eigen::Isometry3d T_right_left_{Eigen::Translation3d(-kCamera.baseline, 0.0, 0.0)};
};

/// Expects a pitch that was found, within a tolerance in px.
void expectPitch(const std::optional<double>& found, double degrees, double tolerance) {
  ASSERT_TRUE(found) << degrees;
  EXPECT_NEAR(*found, degrees * kDegree, tolerance / kCamera.focal_length) << degrees;
}

TEST(PitchReinitialiser, FindsThePitch) {
  for (const double degrees : {-0.55, -0.3, 0.3, 0.55})
    expectPitch(Search().find(leftView(), rightView(degrees * kDegree)), degrees, 0.5);
}

cv::Mat atNight(const cv::Mat& image, int seed) {
  cv::RNG random(static_cast<std::uint64_t>(seed));
  return test::atNight(image, random);
}

TEST(PitchReinitialiser, FindsThePitchAtNight) {
  expectPitch(Search().find(atNight(leftView(), 1), atNight(rightView(0.5 * kDegree), 2)), 0.5, 1.0);
}

TEST(PitchReinitialiser, RefusesImagesOfTwoScenesAtNight) {
  EXPECT_FALSE(Search().find(atNight(leftView(), 1), atNight(rightView(0.0, 4), 2)));
}

TEST(PitchReinitialiser, AllowsForTheRotationBetweenTheExposures) {
  Search search;
  search.turnBetweenExposures(-0.2 * kDegree);
  expectPitch(search.find(leftView(), rightView(0.55 * kDegree)), 0.35, 0.5);
}

TEST(PitchReinitialiser, RefusesImagesOfTwoScenes) {
  EXPECT_FALSE(Search().find(leftView(), rightView(0.0, 4)));
}

TEST(PitchReinitialiser, RefusesAPitchBeyondSelfCalibration) {
  EXPECT_FALSE(Search().find(leftView(), rightView(1.0 * kDegree)));
}

/// A wet lens hides matches as a bump does.
TEST(PitchReinitialiser, LeavesAPitchThatIsRight) {
  for (const double degrees : {0.0, 0.3}) {
    Search search;
    search.know(degrees * kDegree);
    EXPECT_FALSE(search.find(leftView(), rightView(degrees * kDegree))) << degrees;
  }
}

TEST(PitchReinitialiser, ReplacesAKnownPitch) {
  Search search;
  search.know(-0.3 * kDegree);
  expectPitch(search.find(leftView(), rightView(0.3 * kDegree)), 0.3, 0.5);
  EXPECT_LT(search.stddev(), 1e-3);
}

/// The rotation between the exposures of a single pair is not known.
TEST(PitchReinitialiser, IsUncertainOfAPairWithATimeOffset) {
  Search search;
  search.delay(0.02);
  ASSERT_TRUE(search.find(leftView(), rightView(0.5 * kDegree)));
  EXPECT_NEAR(search.stddev(), 0.02 * SelfCalibrationSettings{}.unknown_rate_stddev, 5e-4);
}

TEST(PitchReinitialiser, SearchesOnlyWhereMatchesAreMissing) {
  Search search;
  search.match(30);
  EXPECT_FALSE(search.find(leftView(), rightView(0.3 * kDegree)));
}

TEST(PitchReinitialiser, SearchesAtIntervalsAndOncePerPair) {
  PitchReinitialiser reinitialiser(kCamera, {}, TrackingSettings{}.levels);
  const cv::Mat left = leftView(), right = rightView(0.3 * kDegree);
  Search search;
  for (int i = 0; i < 2 * kInterval + 1; ++i) {
    EXPECT_EQ(search.find(reinitialiser, left, right, i).has_value(), i % kInterval == 0) << i;
    EXPECT_FALSE(search.find(reinitialiser, left, right, i)) << i;
  }
}

}  // namespace
}  // namespace cartvo::vo
