#pragma once

#include <cstdint>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "vo_core/geometry/exposure_motion.hpp"
#include "vo_core/integrity/still_regions.hpp"
#include "vo_core/rig_calibration_error.hpp"
#include "vo_core/tracking/landmark.hpp"
#include "vo_core/tracking/row_correction.hpp"
#include "vo_core/tracking/window_frame.hpp"
#include "vo_core/window/window_solver.hpp"

// The window of `estimator: reprojection` from pair to pair.

namespace cartvo::vo {

/// Knowledge of the shared states before a window, and how they change.
struct SharedPrior {
  SharedVector mean = SharedVector::Zero(), stddev = SharedVector::Zero();
  SharedVector drift = SharedVector::Zero();  ///< stddev after 1 s of a random walk
  double yaw_pattern = 0.0;                   ///< rad, stddev of what the lenses leave that resembles a yaw
};

/// The data that a pair of a track is adjusted with.
struct TrackWindowInput {
  const StereoCamera& camera;
  const RowTiming& timing;
  const SharedPrior& shared;
  const StillRegions& still_regions;       ///< landmarks there are left out
  const std::vector<Landmark>& landmarks;  ///< with the newest pair's observations
  const std::vector<WindowFrame>& window;  ///< at least two; the newest pair last, at its first guess
  /// Stddev of the velocity (m/s, rad/s) at the pair before the newest, if the cart stood until then.
  std::optional<Vector6d> rest;
  double correlated_pairs;  ///< pairs over which the noise's scales are averaged
};

/// Trajectory of a window of a track, all of it free, with the information of what has left it. An anchor's
/// patch is the origin of its landmark's later positions, and its own position is an observation like them: a
/// landmark ends with its anchor, and goes on as another one.
class TrackWindow {
 public:
  struct Pair {
    Eigen::Isometry3d T_world_camera;
    Matrix6d pose_covariance;  ///< relative to the track's first pair; perturbations on the right
    ExposureMotion motion;     ///< about the left exposure
    RightExposure right;
  };
  using Pairs = FixedVector<Pair, kMaximumWindowPairs>;  ///< those of the window, the newest last
  struct Adjusted {
    Pairs pairs;
    WindowMotion motion;                        ///< to the newest pair
    std::optional<WindowMotion> motion_before;  ///< to the pair before it
    ExposureTwist twist;                        ///< at the newest exposure
    ExposureTwist twist_before;                 ///< at the exposure before
    SharedVector shared, shared_stddev;
    bool explained;  ///< whether most of the landmarks fit
    EstimateWithStddev estimate(SharedState state) const { return {shared[state], shared_stddev[state]}; }
  };
  /// A landmark that took part.
  struct AdjustedLandmark {
    std::size_t index;           ///< into TrackWindowInput::landmarks
    double inverse_depth = 0.0;  ///< 1/m, in the anchor's camera at its exposure
    LandmarkFit fit;             ///< without information if it is not in front of that camera
  };

  /// The newest pair, whose right positions are not known yet, by its left ones; without covariance. Nothing
  /// if the geometry is degenerate or most positions do not fit. adjust() with the same pair goes on from
  /// there.
  std::optional<Pair> predict(const TrackWindowInput& input);
  /// Adjusts the window with its newest pair; nothing if the geometry is degenerate. accept() keeps the
  /// result; without it, the pair is forgotten.
  std::optional<Adjusted> adjust(const TrackWindowInput& input);
  void accept();
  /// Begins anew with the next pair.
  void forget();
  /// Landmarks of the last adjust().
  const std::vector<AdjustedLandmark>& landmarks() const { return adjusted_; }
  const WindowNoises& noise() const { return state_.problem.noise; }

 private:
  /// Name of a landmark's life with one anchor: index of the anchor's pair, and its position in it, px.
  using Key = std::tuple<std::int64_t, double, double>;
  struct State {
    WindowProblem problem;
    std::vector<Key> keys;      ///< of problem.landmarks, ascending
    std::int64_t epoch_ns = 0;  ///< exposure that the problem's times count from
    int young = 0;              ///< pairs since the start
    WindowJerkSums jerk_sums;   ///< squares in (m/s^3)^2 and (rad/s^3)^2, of the last pairs
  };

  void prepare(const TrackWindowInput& input);
  Pair pairOf(const WindowPair& pair) const;
  bool follows(const std::vector<WindowFrame>& window) const;
  static void restart(const TrackWindowInput& input, State& state);
  void choose(const TrackWindowInput& input);
  void removeEnded(const TrackWindowInput& input);
  void addLandmarks(const TrackWindowInput& input);
  Adjusted concluded(const WindowResult& result);
  void keepTwistErrors(const WindowResult& result);
  void assumeYaw(double yaw, const WindowResult& result);
  void listAdjusted(const Pairs& pairs);

  State state_, next_;
  // Reused for their memory.
  std::vector<std::pair<Key, std::size_t>> chosen_;  ///< landmarks of the newest pair
  std::vector<std::size_t> taking_part_;  ///< index into the input's landmarks of each of next_.problem's
  std::vector<AdjustedLandmark> adjusted_;
  WindowSolver solver_;
};

}  // namespace cartvo::vo
