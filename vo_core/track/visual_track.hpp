#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "vo_core/estimation/pose_search.hpp"
#include "vo_core/integrity/frozen_camera_detector.hpp"
#include "vo_core/integrity/integrity_monitor.hpp"
#include "vo_core/integrity/standstill.hpp"
#include "vo_core/integrity/still_regions.hpp"
#include "vo_core/landmark_view.hpp"
#include "vo_core/odometry_estimate.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/self_calibration/pitch_reinitialiser.hpp"
#include "vo_core/self_calibration/rig_calibration.hpp"
#include "vo_core/stage_observer.hpp"
#include "vo_core/tracking/landmark_tracker.hpp"
#include "vo_core/tracking/motion_prediction.hpp"
#include "vo_core/tracking/row_correction.hpp"
#include "vo_core/window/track_window.hpp"

// One track of `estimator: reprojection`: tracking, pose search and adjustment of the window for each pair.

namespace cartvo::vo {

/// A pair with its image pyramids.
struct PreparedPair {
  std::int64_t index = 0;
  std::int64_t left_exposure_ns = 0;
  std::int64_t right_exposure_ns = 0;
  double offset_stddev = 0.0;  ///< s
  KeyFrames key_frames{};
  bool from_video = false;            ///< its stream has had a key frame
  double pose_noise_inflation = 1.0;  ///< factor on the variance of its pose: CodecErrorModel
  SharedPyramid left, right;
  IntegrityState state = IntegrityState::tracking;  ///< before the pair
  IntegrityEvidence evidence;
};

/// Motion of a track to a pair.
struct TrackedMotion {
  OdometryReason reason = OdometryReason::none;  ///< why it is invalid, or zero_velocity
  double time_step = 0.0;                        ///< s since the last tracked pair
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_previous_current = Eigen::Isometry3d::Identity();
  /// Covariance of the motion (m and rad, perturbations on the right) by the window, by a standstill, or by
  /// the pose where that ended, by the shifts of key frames that were removed from it, and by a track that is
  /// not established.
  Matrix6d by_window = Matrix6d::Zero(), by_standstill = Matrix6d::Zero(), by_codec_shift = Matrix6d::Zero(),
           by_start = Matrix6d::Zero();
  double codec_inflation = 1.0;        ///< factor on that by the window: PreparedPair::pose_noise_inflation
  bool noise_is_uncalibrated = false;  ///< one of the first motions: their noise is still an assumption
  std::optional<ExposureTwist> twist;  ///< as OdometryEstimate's
  /// That the landmarks of the motion are those of the world, by this pair; before the track is established.
  double log_odds = 0.0;
  FeatureCounts counts;
  bool part_stands = false;    ///< OdometryEstimate::part_stands
  IntegrityEvidence evidence;  ///< of the pair and the track

  bool valid() const { return reason == OdometryReason::none || reason == OdometryReason::zero_velocity; }
  Vector6d stddevByWindow() const { return by_window.diagonal().cwiseMax(0.0).cwiseSqrt(); }
  Matrix6d covariance() const {
    return codec_inflation * by_window + by_standstill + by_codec_shift + by_start;
  }
};

/// Squares of changes of estimates over their variances, by component.
using AxisErrors = std::array<ResidualVariance, 6>;

/// Estimates about the cameras that one track hands to the next.
struct LearntByTracks {
  RigCalibration rig;
  ReadoutEstimates readouts;
  StillRegions still_regions;
  /// Share of the landmarks that have a match in the right image, mean of the last pairs. At dusk few corners
  /// of a first picture are found again, so a low share of one pair means nothing.
  double stereo_share = 0.5;
};

/// Motion through an uninterrupted sequence of pairs: a sliding window of poses and the landmarks they share.
/// A pair with an invalid motion leaves the track unchanged.
class VisualTrack {
 public:
  /// Starts at the pair `first`, which is the origin. `reinitialiser`: used for this pair; shared by all
  /// tracks, as each pair may start one.
  VisualTrack(const StereoCamera& camera, const OdometrySettings& settings, const RowTiming& timing,
              const PreparedPair& first, const LearntByTracks& learnt, PitchReinitialiser& reinitialiser,
              StageObserver& observer);

  /// Tracks the next pair and, if its motion is valid, adds it.
  TrackedMotion process(const PreparedPair& pair, StageObserver& observer);
  void setTargetFeatureCount(int features) { tracker_.setTargetFeatureCount(features); }

  const Eigen::Isometry3d& pose() const { return window_.back().T_world_camera; }
  const Matrix6d& poseCovariance() const { return window_.back().pose_covariance; }
  bool hasMotion() const { return velocity_.has_value(); }
  /// Whether the landmarks of the motion are those of the world. A track that begins in motion among vehicles
  /// may follow one of these; the next pairs tell.
  bool isEstablished() const;
  std::int64_t lastExposure() const { return last_exposure_ns_; }  ///< ns, of the last tracked pair
  int landmarkCount() const { return static_cast<int>(landmarks_.size()); }
  /// Adds the landmarks that the pair with this index observed.
  void viewLandmarks(std::int64_t pair, LandmarkViews& views) const;
  int stereoCount() const;  ///< landmarks found in the last pair's right image
  const RigCalibration& rig() const { return estimates_.rig; }
  std::optional<RigCalibrationError> rigCalibrationError() const;  ///< empty if it is not estimated
  const StillRegions& stillRegions() const { return estimates_.still_regions; }
  LearntByTracks learnt() const {
    return {estimates_.rig, estimates_.readouts, estimates_.still_regions, stereo_share_};
  }
  std::optional<ReadoutEstimates> readouts() const;  ///< empty with global shutters that are known

 private:
  /// Estimates about the cameras from the motions.
  struct Estimates {
    RigCalibration rig;
    ReadoutEstimates readouts;
    StillRegions still_regions;
    PredictionErrors prediction_errors;
    // The last ones as they were estimated then, and errors of such ones as the next pair shows them.
    std::optional<WindowMotion> motion;
    std::optional<ExposureTwist> twist;
    AxisErrors motion_errors, twist_errors;
  };

  /// Landmarks, window and estimates with the current pair, before it is accepted.
  struct Draft {
    std::vector<Landmark> landmarks;
    std::vector<WindowFrame> window;                          ///< the pair is the last
    Estimates estimates;                                      ///< set by adjust()
    Eigen::Isometry3d start = Eigen::Isometry3d::Identity();  ///< first guess of the pair's pose
    bool prediction_failed = false;                           ///< TrackingOutcome::prediction_failed
    Matrix6d pose_covariance = Matrix6d::Zero();              ///< of the pose found, by its inliers
    MotionPredictions predictions{};
  };

  // visual_track.cpp
  TrackedMotion track(const PreparedPair& pair, StageObserver& observer);
  void trackLandmarks(const PreparedPair& pair, Draft& draft, TrackedMotion& motion, StageObserver& observer);
  void predictMotion(const PreparedPair& pair, Draft& draft);
  void addRowNoise(const Draft& draft);
  void correctNewestRows(Draft& draft, const Eigen::Isometry3d& T_world_camera);
  void searchAgainAtFoundPose(const PreparedPair& pair, TrackedImage& image, Draft& draft);
  void replenishLandmarks(const PreparedPair& pair, Draft& draft, TrackedMotion& motion,
                          StageObserver& observer);
  double secondsSinceLast(const PreparedPair& pair) const;
  Eigen::Isometry3d expectedPose(const PreparedPair& pair) const;
  bool searchPose(const PreparedPair& pair, Draft& draft, TrackedMotion& motion);
  std::optional<FoundPose> findPose();
  Vector6d admissibleChange(const PreparedPair& pair) const;
  void buildPoseProblem(const PreparedPair& pair, const Draft& draft);
  void matchStereo(const PreparedPair& pair, const std::vector<WindowFrame>& window,
                   PitchReinitialiser& reinitialiser, std::vector<Landmark>& landmarks);
  void accept(const PreparedPair& pair, Draft& draft);
  bool estimatesRig() const;

  // visual_track_ambiguity.cpp
  std::optional<AlternativePose> findLikelyAlternative();
  bool isAmbiguous(const PreparedPair& pair, const FoundPose& found, TrackedMotion& motion);
  std::optional<AlternativePose> measureOdds(const FoundPose& found, TrackedMotion& motion);
  void addStartUncertainty(TrackedMotion& motion);

  // visual_track_standstill.cpp
  void applyZeroVelocity(const PreparedPair& pair, TrackedMotion& motion);
  void refreshStandstill(const PreparedPair& pair, Draft& draft, const TrackedMotion& motion);
  bool observeLeft(const Draft& draft, IntegrityEvidence& evidence) const;
  std::optional<RightDisplacement> localiseRight(const std::vector<WindowFrame>& window,
                                                 const std::vector<Landmark>& landmarks);
  void checkRightCamera(const PreparedPair& pair, Draft& draft, IntegrityEvidence& evidence,
                        StageObserver& observer);
  bool isRejected(const PreparedPair& pair, TrackedMotion& motion) const;

  // visual_track_adjustment.cpp
  SharedPrior sharedPrior(const PreparedPair& pair, const Estimates& estimates) const;
  TrackWindowInput windowInput(const PreparedPair& pair, const SharedPrior& shared, const Draft& draft) const;
  void predictByWindow(const PreparedPair& pair, Draft& draft);
  void adjust(const PreparedPair& pair, Draft& draft, TrackedMotion& motion);
  void useAdjusted(const TrackWindow::Adjusted& adjusted, const SharedPrior& prior, Draft& draft);
  bool restartAfterBump(Draft& draft);
  bool restartWithOpenYaw(const TrackWindow::Adjusted& adjusted, const SharedPrior& prior, Draft& draft);
  void updateErrors(const TrackWindow::Adjusted& adjusted, Estimates& estimates) const;
  void updateLandmarks(Draft& draft);
  bool lacksStereo(TrackedMotion& motion);
  bool stopsTooFast(const PreparedPair& pair, TrackedMotion& motion) const;
  OdometryReason validate(const TrackedMotion& motion) const;

  StereoCamera camera_;
  OdometrySettings settings_;
  RowTiming timing_;  ///< with the readouts of the current pair
  MotionComponents predicted_variances_ = MotionComponents::Zero();
  LandmarkTracker tracker_;
  SubsetRandom random_;
  PitchReinitialiser pitch_reinitialiser_;  ///< for pairs after the first
  StandstillDetector standstill_;
  FrozenCameraDetector frozen_camera_;
  Estimates estimates_;  ///< changed by pairs with a valid motion, and by pitch_reinitialiser_
  double stereo_share_;  ///< LearntByTracks::stereo_share
  bool standing_ = false;
  int landmarks_when_stopped_ = 0;  ///< matched by the first pair of the standstill
  std::vector<Landmark> landmarks_;
  std::vector<WindowFrame> window_;   ///< oldest first; never empty
  double log_odds_ = 0.0;             ///< sum of TrackedMotion::log_odds
  std::optional<Vector6d> velocity_;  ///< at the last pair, in its axes, m/s and rad/s; empty after the first
  std::int64_t last_exposure_ns_ = 0;  ///< of the last tracked pair
  std::int64_t unambiguous_ns_ = 0;    ///< exposure of the last pair without an alternative pose
  // State of the current pair; members to reuse their memory.
  Draft draft_;
  std::vector<std::size_t>
      chosen_;  ///< indices into draft_.landmarks of the landmarks of the last problem built
  PoseProblem pose_problem_;
  PoseFinder pose_finder_;
  TrackWindow track_window_;
  std::vector<double> right_rows_;
};

}  // namespace cartvo::vo
