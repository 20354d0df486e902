#pragma once

#include <cstdint>

namespace cartvo {

/// How the motion is estimated.
enum class Estimator : std::uint8_t {
  reprojection,  ///< robust least squares on the reprojection error in both images over a window of pairs
  thesis,        ///< Horn's absolute orientation on weighted 3D-3D pairs (thesis 4.15, 4.16)
};

/// Levels of the pyramids that patches of landmarks are taken from at most: the image itself and its half.
constexpr int kLandmarkLevels = 2;

/// Windows with adaptive FAST thresholds (thesis 4.9).
struct DetectionSettings {
  int levels = kLandmarkLevels;  ///< of the pyramid, the full image among them, that corners are taken from
  int window_columns = 16;       ///< windows side by side
  int window_rows = 5;           ///< windows one above the other
  int minimum_threshold = 6;     ///< grey values; no window's threshold falls below
  int maximum_threshold = 80;    ///< grey values; nor rises above
  int initial_threshold = 20;    ///< grey values, of each window before the first image
};

/// KLT from frame to frame (thesis 4.10-4.13).
struct TrackingSettings {
  int levels = 4;                    ///< of the pyramid, the full image among them
  int iterations = 6;                ///< at most, of the last, affine step
  double convergence = 0.1;          ///< px; the track is done when a step is shorter
  double minimum_correlation = 0.8;  ///< normalised, of the patch before and after
  double maximum_return = 0.5;       ///< px by which an alignment backwards may miss its start
  double minimum_score = 60.0;       ///< FAST score (4.9) below which a feature is not worth tracking
  double minimum_distance = 8.0;     ///< px between features; less where `features` leaves no room for it
  int search_again =
      5;  ///< pairs in which a lost feature that has a depth is looked for before it is dropped
};

/// The match from left to right (thesis 4.1-4.4, 4.14).
struct StereoSettings {
  double minimum_disparity = 0.5;     ///< px; what is farther has no usable depth
  int maximum_disparity = 128;        ///< px; what is nearer is not found
  int rows = 1;                       ///< px above and below in which the match may lie
  double minimum_correlation = 0.85;  ///< normalised, of left and right patch
  double uniqueness = 0.8;            ///< 1 - correlation is at most so much of the best rival's elsewhere
};

/// Horn's method over subsets, then weights by prediction error (thesis 4.15, 4.16).
struct MotionSettings {
  int subsets = 128;             ///< random subsets, each giving one pose
  int subset_size = 4;           ///< features in each
  int iterations = 10;           ///< of the weights w = 1/|c|, at most
  double radius = 3.5;           ///< standard deviations of a feature's point beyond which it weighs nothing
  double pixel_noise = 0.2;      ///< px, standard deviation assumed of a tracked position far away
  double disparity_noise = 0.2;  ///< px, standard deviation assumed of a disparity far away
  double near_noise = 0.01;      ///< added to both for each px of disparity: near patches deform more
};

/// What a feature's motion over t-2, t-1, t says of it; of a landmark, how it fitted pair by pair.
struct HistorySettings {
  double deviation = 2.0;       ///< standard deviations of that at which a feature tends to half its weight
  double minimum_weight = 0.2;  ///< below, a feature is removed
};

/// Refinement over the last frames (thesis 5.1).
struct RefinementSettings {
  int frames = 5;      ///< m: the new frame is fitted to the last m - 1; 1 switches the refinement off
  int iterations = 6;  ///< at most
};

/// The search for the first estimate of a pose among moving objects and false matches.
struct PoseSearchSettings {
  int subsets = 60;      ///< random subsets at most
  double gate = 3.0;     ///< standard deviations within which a point is explained
  double enough = 0.75;  ///< share of the points' weight: a start that explains so much needs no search
  double maximum_acceleration = 25.0;  ///< m/s^2; a motion that changes faster is somebody else's
  double maximum_turn = 40.0;          ///< rad/s^2
};

constexpr int kMostWindowPairs = 8;  ///< pairs, with the one that has just come

/// The least squares over the window of pairs.
struct BundleSettings {
  int frames = 7;       ///< pairs in the window, less than kMostWindowPairs
  int free_frames = 2;  ///< of these the newest move; the older ones stand
  /// Of what was known of a pose when it was published, so much holds it while it is still free: not all, for
  /// the sightings that it is known by are in the window once more. 0: nothing.
  double hold = 0.3;
  /// Poses that stand err, each all landmarks alike, but count as exact. So of what is told against them,
  /// left positions in their pairs and depths that earlier hosts knew, so much counts. 1: all.
  double standing_share = 0.2;
  int iterations = 4;         ///< at most
  double convergence = 0.1;   ///< standard deviations, rms; done when a step of the poses is shorter
  double robust_width = 1.5;  ///< standard deviations at which a residual has half its weight
};

/// When the cart is taken to stand.
struct StandstillSettings {
  double translation = 0.0015;  ///< m that the pose may stray
  double rotation = 0.0002;     ///< rad
  double least_time = 0.25;     ///< s, for so long at least
};

/// What is done about a rig that is not as calibrated.
enum class RigRefinement : std::uint8_t {
  off,
  correct,  ///< it is estimated, and measurements are corrected
};

/// When a motion is believed.
struct ValiditySettings {
  int minimum_features = 30;          ///< alive in the left image
  int minimum_matches = 20;           ///< with a point before and now
  int minimum_inliers = 15;           ///< explained by the motion
  double minimum_inlier_ratio = 0.3;  ///< of the matches
  double maximum_residual = 3.0;   ///< median of the matches' errors, in units of that of the assumed noise
  double maximum_time_step = 1.0;  ///< s between pairs
  double maximum_offset = 0.1;     ///< s between the exposures of a pair
  double maximum_offset_uncertainty = 0.01;  ///< s, standard deviation of that
  double maximum_speed = 50.0;               ///< m/s; no cart is faster
  double maximum_rate = 4.0;                 ///< rad/s
  double maximum_deviation = 0.1;            ///< m and rad, standard deviation of each component of a motion
};

struct OdometrySettings {
  Estimator estimator = Estimator::reprojection;
  int features = 1000;     ///< aimed at in each left image, 50 to 20000
  std::uint64_t seed = 1;  ///< of the random subsets
  DetectionSettings detection;
  TrackingSettings tracking;
  StereoSettings stereo;
  MotionSettings motion;
  HistorySettings history;
  RefinementSettings refinement;
  PoseSearchSettings pose_search;
  BundleSettings bundle;
  StandstillSettings standstill;
  RigRefinement rig_refinement = RigRefinement::correct;
  ValiditySettings validity;
};

/// px between features in an image of that size; less than the setting where the aimed number of features
/// leaves no room for it.
double minimumDistance(const OdometrySettings& settings, int width, int height);

/// Throws std::invalid_argument naming the value, as in "tracking.levels is 0: expected 1 to 8".
void validate(const OdometrySettings& settings);

}  // namespace cartvo
