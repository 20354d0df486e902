#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "vo_core/bundle_adjustment.hpp"
#include "vo_core/landmark_tracker.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/patch_overlap.hpp"
#include "vo_core/pitch_suspicion.hpp"
#include "vo_core/pose_search.hpp"
#include "vo_core/repeated_pictures.hpp"
#include "vo_core/rig_monitor.hpp"
#include "vo_core/stand_witness.hpp"
#include "vo_core/standstill.hpp"
#include "vo_core/stereo_odometry.hpp"

namespace cartvo {

/// A pair, prepared.
struct PreparedPair {
  std::int64_t index = 0;
  std::int64_t left_exposure_ns = 0;
  std::int64_t right_exposure_ns = 0;
  double offset_deviation = 0.0;  ///< s
  KeyFrames key_frames{};
  bool coded = false;   ///< its pictures are of a video, of which a key frame has been seen
  double excess = 1.0;  ///< of its pose's variance, times what the landmarks tell: VideoErrors'
  SharedPyramid left, right;
  PictureRepeats repeats;
};

/// What a pair told a track.
struct TrackedMotion {
  OdometryReason reasons = OdometryReason::none;  ///< why it is not to be believed, or that the cart stands
  double time_step = 0.0;                         ///< s, since the last pair that the track took in
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_previous_current = Eigen::Isometry3d::Identity();
  Matrix6d motion_covariance = Matrix6d::Zero();
  Vector6d deviation_by_landmarks = Vector6d::Zero();  ///< of the motion, with no other doubt in it
  bool guessed = false;  ///< so is the noise that this goes by: one of the track's first motions
  Vector6d motion_offset_error = Vector6d::Zero();  ///< as OdometryEstimate's
  bool rivalled = false;  ///< another first motion explains nearly as much: nobody knows which the cart's is
  FeatureCounts counts;

  bool valid() const { return reasons == OdometryReason::none || reasons == OdometryReason::zero_velocity; }
};

/// An unbroken run of pairs: their poses since the first one, and the landmarks they share. A pair that
/// cannot be explained leaves it as it was.
class VisualTrack {
 public:
  /// Begins at a pair, which is the origin. `rig`: what is known of the rig so far; `suspicion`: that of all
  /// first pairs.
  VisualTrack(const StereoCamera& camera, const OdometrySettings& settings, const PreparedPair& first,
              const RigMonitor& rig, PitchSuspicion& suspicion, StageObserver& observer);

  TrackedMotion process(const PreparedPair& pair, StageObserver& observer);
  void aimAt(int features) { tracker_.aimAt(features); }

  const Eigen::Isometry3d& pose() const { return window_.back().T_world_camera; }
  Matrix6d poseCovariance() const;
  std::int64_t lastExposure() const { return last_exposure_ns_; }
  /// Whether the left picture stands still while the right camera moves: it cannot be believed.
  bool leftHangs() const { return stand_witness_.denies(); }
  /// m/s and rad/s of the camera, in its axes, at the last pair; nothing after the first.
  const std::optional<Vector6d>& velocity() const { return velocity_; }
  int landmarkCount() const { return static_cast<int>(landmarks_.size()); }
  int stereoCount() const;  ///< of the landmarks, found in the last pair's right image
  const RigMonitor& rig() const { return rig_; }
  std::optional<RigCheck> rigCheck() const;  ///< nothing where the rig is not watched

 private:
  /// What a pair would become in the window, before it is accepted.
  struct Draft {
    std::vector<Landmark> landmarks;
    std::vector<WindowFrame> window;  ///< the pair is the last
  };

  TrackedMotion explain(const PreparedPair& pair, StageObserver& observer);
  bool corrects() const;
  double secondsSinceLast(const PreparedPair& pair) const;
  Eigen::Isometry3d expectedPose(const PreparedPair& pair) const;
  bool searchPose(const PreparedPair& pair, Draft& draft, TrackedMotion& motion);
  bool rivalled(const FoundPose& found) const;
  Vector6d admissibleChange(const PreparedPair& pair) const;
  void statePoseProblem(const PreparedPair& pair, const Draft& draft);
  void matchStereo(const PreparedPair& pair, const std::vector<WindowFrame>& window,
                   PitchSuspicion& suspicion, std::vector<Landmark>& landmarks);
  void stateBundle(const Draft& draft, const RigCorrection& rig);
  void adjust(const PreparedPair& pair, Draft& draft, TrackedMotion& motion);
  void weigh(Draft& draft) const;
  OdometryReason judge(const TrackedMotion& motion, const Matrix6d& covariance) const;
  RigMonitor rigAfter(const BundleResult& result, const Draft& draft, const RigCorrection& applied);
  void holdStill(const PreparedPair& pair, TrackedMotion& motion);
  bool expectsToMove(const PreparedPair& pair) const;
  void askRight(const PreparedPair& pair, bool stays, Draft& draft, StageObserver& observer);
  void renewStand(const PreparedPair& pair, Draft& draft, const TrackedMotion& motion);
  void accept(const PreparedPair& pair, Draft& draft);

  StereoCamera camera_;
  OdometrySettings settings_;
  LandmarkTracker tracker_;
  SubsetRandom random_;
  BundleNoises noise_;
  RigMonitor rig_;                  ///< knows of nothing unless it is to be corrected
  PitchSuspicion pitch_suspicion_;  ///< at later pairs than the first
  StandstillDetector standstill_;
  StandWitness stand_witness_;
  bool standing_ = false;
  int landmarks_when_stopped_ = 0;  ///< matched by the first pair of the stand
  std::vector<Landmark> landmarks_;
  std::vector<WindowFrame> window_;             ///< oldest first; never empty
  std::optional<Vector6d> velocity_;            ///< as velocity() tells
  Vector6d last_deviation_ = Vector6d::Zero();  ///< of the last motion, by its landmarks
  std::int64_t last_exposure_ns_ = 0;           ///< of the last pair that was explained
  // Of the present pair only; kept for their memory.
  Draft draft_;
  std::vector<std::size_t> chosen_;  ///< landmarks of the draft: those that the problem last stated is about
  PoseProblem pose_problem_;
  PoseFinder pose_finder_;
  BundleProblem bundle_;
  std::vector<double> rows_;
  PatchOverlap overlap_;
  BundleAdjuster adjuster_;
  RowRegression row_regression_;
};

}  // namespace cartvo
