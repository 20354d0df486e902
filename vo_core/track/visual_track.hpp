#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "vo_core/estimation/bundle_adjustment.hpp"
#include "vo_core/estimation/cell_noise.hpp"
#include "vo_core/estimation/motion_error.hpp"
#include "vo_core/estimation/patch_overlap.hpp"
#include "vo_core/estimation/pose_search.hpp"
#include "vo_core/integrity/frozen_camera_detector.hpp"
#include "vo_core/integrity/integrity_monitor.hpp"
#include "vo_core/integrity/standstill.hpp"
#include "vo_core/integrity/still_regions.hpp"
#include "vo_core/landmark_view.hpp"
#include "vo_core/odometry_estimate.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/rolling_shutter/motion_prediction.hpp"
#include "vo_core/rolling_shutter/motion_roughness.hpp"
#include "vo_core/rolling_shutter/row_motion.hpp"
#include "vo_core/self_calibration/pitch_reinitialiser.hpp"
#include "vo_core/self_calibration/readout_estimator.hpp"
#include "vo_core/self_calibration/rig_calibration_filter.hpp"
#include "vo_core/stage_observer.hpp"
#include "vo_core/tracking/landmark_tracker.hpp"
#include "vo_core/tracking/row_correction.hpp"
#include "vo_core/window/track_window.hpp"

// One track of `estimator: reprojection`: tracking, pose search and bundle adjustment for each pair.

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
  MotionError error;
  std::optional<ExposureTwist> twist;  ///< as OdometryEstimate's
  FeatureCounts counts;
  IntegrityEvidence evidence;  ///< of the pair and the track

  bool valid() const { return reason == OdometryReason::none || reason == OdometryReason::zero_velocity; }
  Vector6d stddevByLandmarks() const { return error.by_landmarks.diagonal().cwiseMax(0.0).cwiseSqrt(); }
  /// Of what poses tell of the motion about an exposure.
  Vector6d stddevByPoses() const {
    return (error.by_landmarks.diagonal().cwiseMax(0.0) + error.by_readout.cwiseAbs2()).cwiseSqrt();
  }
  /// Whether it is one of the first motions: the noise level is still an assumption.
  bool noiseIsUncalibrated() const { return error.startup_inflation > 1.0; }
};

/// Estimates about the cameras that one track hands to the next.
struct LearntByTracks {
  RigCalibrationFilter rig;
  ReadoutEstimators readouts;
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
  Matrix6d poseCovariance() const;
  bool hasMotion() const { return velocity_.has_value(); }
  std::int64_t lastExposure() const { return last_exposure_ns_; }  ///< ns, of the last tracked pair
  int landmarkCount() const { return static_cast<int>(landmarks_.size()); }
  /// Adds the landmarks that the pair with this index observed.
  void viewLandmarks(std::int64_t pair, LandmarkViews& views) const;
  int stereoCount() const;  ///< landmarks found in the last pair's right image
  const RigCalibrationFilter& rig() const { return estimates_.rig; }
  std::optional<RigCalibrationError> rigCalibrationError() const;  ///< empty if it is not estimated
  const StillRegions& stillRegions() const { return estimates_.still_regions; }
  LearntByTracks learnt() const {
    return {estimates_.rig, estimates_.readouts, estimates_.still_regions, stereo_share_};
  }
  std::optional<ReadoutEstimates> readouts() const;  ///< empty with global shutters that are known

 private:
  /// Estimates about cameras and road from the motions.
  struct Estimates {
    RigCalibrationFilter rig;
    ReadoutEstimators readouts;
    StillRegions still_regions;
    MotionRoughness roughness;
    PredictionErrors prediction_errors;
    Vector6d readout_error = Vector6d::Zero();  ///< MotionError::by_readout of the last motion
  };

  /// Landmarks, window and estimates with the current pair, before it is accepted.
  struct Draft {
    std::vector<Landmark> landmarks;
    std::vector<WindowFrame> window;                          ///< the pair is the last
    Estimates estimates;                                      ///< set by adjust()
    Eigen::Isometry3d start = Eigen::Isometry3d::Identity();  ///< first guess of the pair's pose
    bool prediction_failed = false;                           ///< TrackingOutcome::prediction_failed
    MotionPredictions predictions{};                          ///< with rolling shutters
  };

  // visual_track.cpp
  TrackedMotion track(const PreparedPair& pair, StageObserver& observer);
  void trackLandmarks(const PreparedPair& pair, Draft& draft, TrackedMotion& motion, StageObserver& observer);
  void correctNewestRows(Draft& draft, const Eigen::Isometry3d& T_world_camera);
  void searchAgainAtFoundPose(const PreparedPair& pair, TrackedImage& image, Draft& draft);
  void replenishLandmarks(const PreparedPair& pair, Draft& draft, TrackedMotion& motion,
                          StageObserver& observer);
  double secondsSinceLast(const PreparedPair& pair) const;
  Eigen::Isometry3d expectedPose(const PreparedPair& pair) const;
  bool searchPose(const PreparedPair& pair, Draft& draft, TrackedMotion& motion);
  std::optional<AlternativePose> findLikelyAlternative(const FoundPose& found);
  bool isAmbiguous(const PreparedPair& pair, const FoundPose& found);
  std::optional<FoundPose> findPose();
  Vector6d admissibleChange(const PreparedPair& pair) const;
  void buildPoseProblem(const PreparedPair& pair, const Draft& draft);
  void matchStereo(const PreparedPair& pair, const std::vector<WindowFrame>& window,
                   PitchReinitialiser& reinitialiser, std::vector<Landmark>& landmarks);
  void accept(const PreparedPair& pair, Draft& draft);
  bool estimatesRig() const;

  // visual_track_standstill.cpp
  void applyZeroVelocity(const PreparedPair& pair, TrackedMotion& motion);
  void refreshStandstill(const PreparedPair& pair, Draft& draft, const TrackedMotion& motion);
  std::optional<RightDisplacement> localiseRight(const std::vector<WindowFrame>& window,
                                                 const std::vector<Landmark>& landmarks);
  void checkRightCamera(const PreparedPair& pair, Draft& draft, IntegrityEvidence& evidence,
                        StageObserver& observer);
  bool isRejected(const PreparedPair& pair, TrackedMotion& motion) const;

  // visual_track_rows.cpp
  enum class RigSide : std::uint8_t { left, right };
  /// A camera of a pair at its own exposure, and its motion about it.
  struct ReadoutView {
    std::int64_t index = 0;
    Eigen::Isometry3d T_world_camera;
    ExposureMotion motion;
  };
  void predictMotion(const PreparedPair& pair, Draft& draft);
  void addRowNoise(const Draft& draft);
  std::optional<Matrix6d> estimateRowMotion(Draft& draft);
  Matrix6d errorOfFirstRows(std::size_t pairs) const;
  std::size_t firstToCorrect(const std::vector<WindowFrame>& window) const;
  void updateRowConsistency(Draft& draft) const;
  void concludeRowMotion(const Matrix6d& by_rows, Draft& draft, TrackedMotion& motion) const;
  void setRowProblem(const ExposureMotion& expected, const RowInformation::Vector& variances);
  void addRowPoints(const Draft& draft);
  std::optional<ReadoutEquation> measureReadout(const Draft& draft, const TimedPoses& poses, int position,
                                                RigSide side);
  void addReadoutPoints(const Draft& draft, const ReadoutView& before, const ReadoutView& now, RigSide side);
  void updateReadouts(Draft& draft);
  void timeAnew(Draft& draft, bool rows_hold);
  void updateMotion(const TimedPoses& poses, int position, const Vector6d& motion_stddev, Draft& draft) const;

  // visual_track_adjustment.cpp
  void buildBundleProblem(const Draft& draft, const RigCorrection& rig);
  BundleResult adjustWithRig(Draft& draft);
  std::optional<Eigen::Isometry3d> motionByLongerReadouts(Draft& draft);
  void adjust(const PreparedPair& pair, Draft& draft, TrackedMotion& motion);
  void updateLandmarks(Draft& draft);
  bool usesWindow() const { return settings_.estimator == Estimator::window; }
  void keepReadoutError(Draft& draft, Vector6d& error) const;
  bool lacksStereo(TrackedMotion& motion);
  bool stopsTooFast(const PreparedPair& pair, TrackedMotion& motion) const;
  OdometryReason validate(const TrackedMotion& motion) const;
  RigCalibrationFilter updatedRig(const BundleResult& result, const Draft& draft,
                                  const RigCorrection& applied);

  // visual_track_window.cpp
  TrackWindowInput windowInput(const PreparedPair& pair, const SharedPrior& shared,
                               const Estimates& estimates, const Draft& draft) const;
  void predictByWindow(const PreparedPair& pair, Draft& draft);
  bool adjustWindow(const PreparedPair& pair, Draft& draft, TrackedMotion& motion);
  SharedPrior sharedPrior(const PreparedPair& pair, const Estimates& estimates) const;
  void setFrame(const TrackWindow::Pair& pair, WindowFrame& frame) const;
  void timeByWindow(const TrackWindow::Adjusted& adjusted, Draft& draft);

  StereoCamera camera_;
  OdometrySettings settings_;
  RowTiming timing_;  ///< with the readouts of the current pair
  RowInformation::Vector predicted_variances_ = RowInformation::Vector::Zero();
  LandmarkTracker tracker_;
  SubsetRandom random_;
  BundleNoises noise_;
  CellNoise cell_noise_;
  PitchReinitialiser pitch_reinitialiser_;  ///< for pairs after the first
  StandstillDetector standstill_;
  FrozenCameraDetector frozen_camera_;
  Estimates estimates_;  ///< changed by pairs with a valid motion, and by pitch_reinitialiser_
  double stereo_share_;  ///< LearntByTracks::stereo_share
  bool standing_ = false;
  int landmarks_when_stopped_ = 0;  ///< matched by the first pair of the standstill
  std::vector<Landmark> landmarks_;
  std::vector<WindowFrame> window_;   ///< oldest first; never empty
  std::optional<Vector6d> velocity_;  ///< at the last pair, in its axes, m/s and rad/s; empty after the first
  Vector6d last_stddev_ = Vector6d::Zero();  ///< TrackedMotion::stddevByPoses() of the last motion
  std::int64_t last_exposure_ns_ = 0;        ///< of the last tracked pair
  std::int64_t unambiguous_ns_ = 0;          ///< exposure of the last pair without an alternative pose
  // State of the current pair; members to reuse their memory.
  Draft draft_;
  std::vector<std::size_t>
      chosen_;  ///< indices into draft_.landmarks of the landmarks of the last problem built
  PoseProblem pose_problem_;
  PoseFinder pose_finder_;
  BundleProblem bundle_;
  std::vector<Landmark> kept_landmarks_;
  PatchOverlap overlap_;
  BundleAdjuster adjuster_;
  TrackWindow track_window_;  ///< with `estimator: window`
  RowMotionProblem row_problem_;
  RowMotionEstimator row_motion_;
  RowRegression row_regression_;
};

}  // namespace cartvo::vo
