#pragma once

#include <cstdint>

#include "vo_core/self_calibration_settings.hpp"

// Settings of StereoOdometry with their defaults; validate() has the permitted ranges.

namespace cartvo::vo {

/// Method that estimates the motion.
enum class Estimator : std::uint8_t {
  reprojection,  ///< the most likely continuous trajectory by reprojection errors in both images of a window
  thesis,        ///< Horn's absolute orientation on weighted 3D-3D pairs (thesis 4.15, 4.16)
};

/// Number of pyramid levels that landmark patches are taken from: the full image and its half.
constexpr int kLandmarkLevels = 2;

/// Share that counts as most: of landmarks, of inliers, of a weight.
constexpr double kMajority = 0.5;

/// Detection windows with adaptive FAST thresholds (thesis 4.9).
struct DetectionSettings {
  int levels = kLandmarkLevels;      ///< pyramid levels with corners, the full image included
  int window_columns = 16;           ///< number of windows side by side
  int window_rows = 5;               ///< number of windows one above the other
  int minimum_threshold = 6;         ///< grey values, lower bound of a window's threshold
  int maximum_threshold = 80;        ///< grey values, upper bound of a window's threshold
  double corners_per_feature = 2.0;  ///< target number of corners of a window per target feature
  double adaptation_exponent = 0.2;  ///< of the ratio of counts by which a threshold changes
  double trial_memory = 200.0;       ///< pairs, memory of a window's success rate
  double level_sharpness = 8.0;      ///< exponent of the levels' utilities by which they share a window
};

constexpr int kMaximumSearchAgain = 7;  ///< upper bound of TrackingSettings::search_again, pairs

/// KLT tracking from frame to frame (thesis 4.10-4.13).
struct TrackingSettings {
  int levels = 4;                          ///< pyramid levels, the full image included
  int iterations = 6;                      ///< maximum number of iterations of the last, affine step
  double convergence = 0.1;                ///< px, length of a step that ends the iteration
  double minimum_correlation = 0.8;        ///< normalised cross-correlation of the patches
  double maximum_backward_error = 0.5;     ///< px, forward-backward error
  double minimum_distance = 8.0;           ///< px between features; see minimumDistance()
  int search_again = 5;                    ///< pairs over which a lost feature with a depth is searched for
  double minimum_shift_correlation = 0.4;  ///< of the shifted patch, before its warp is estimated
  double maximum_stretch = 0.35;           ///< of a warp from the identity; above, the anchor changes
  /// px; landmarks found farther from it contradict a prediction.
  double maximum_prediction_error = 4.0;
  double predicted_inverse_depth = 0.02;  ///< 1/m, predicts where landmarks without a depth appear
  double minimum_patch_noise = 0.07;      ///< px of the level, stddev of the position of the steepest patch
  double minimum_codec_noise = 0.12;      ///< px, the same in inter-coded pictures
};

/// Stereo matching from left to right (thesis 4.1-4.4, 4.14).
struct StereoSettings {
  double minimum_disparity = 0.5;  ///< px; points farther away have no usable depth
  int maximum_disparity = 128;     ///< px; nearer points are not found. `estimator: thesis` only
  int rows = 1;  ///< px of the level, rows searched above and below; a match is at most half a row beyond
  double minimum_correlation = 0.85;  ///< normalised cross-correlation of left and right patch
  double uniqueness = 0.8;         ///< maximum ratio of 1 - correlation of the best to the second-best match
  double maximum_sad_ratio = 1.3;  ///< of a candidate to the least one; above, it is ignored
};

/// Horn's method over subsets, then weights by prediction error (thesis 4.15, 4.16).
struct MotionSettings {
  int subsets = 128;              ///< random subsets, each of which gives one pose
  int subset_size = 4;            ///< features per subset
  int iterations = 10;            ///< maximum number of iterations of the weights w = 1/|c|
  double radius = 3.5;            ///< standard deviations of a point beyond which its weight is zero
  double pixel_noise = 0.2;       ///< px, standard deviation of a tracked position of a distant point
  double disparity_noise = 0.2;   ///< px, standard deviation of the disparity of a distant point
  double maximum_residual = 3.0;  ///< median residual, in units of that of the assumed noise
  double near_noise = 0.01;       ///< px added to both per px of disparity: near patches deform more
};

/// Weights from history: of a feature from its motion over t-2, t-1, t; of a landmark from its residuals.
struct HistorySettings {
  double half_weight_stddevs = 2.0;  ///< standard deviations of the motion or residual that halve the weight
  double minimum_weight = 0.2;       ///< features below are removed
};

constexpr int kMaximumRefinementFrames = 8;  ///< upper bound of RefinementSettings::frames

/// Refinement over the last frames (thesis 5.1).
struct RefinementSettings {
  int frames = 5;      ///< m: the new frame is fitted to the last m - 1; 1 disables the refinement
  int iterations = 6;  ///< maximum number of iterations
};

/// RANSAC for the initial pose among moving objects and false matches.
struct PoseSearchSettings {
  int subsets = 60;   ///< maximum number of random subsets
  double gate = 3.0;  ///< standard deviations of a residual within which a point is an inlier
  double maximum_acceleration = 30.0;  ///< m/s^2 and rad/s^2, gate of the change of the motion
  double minimum_share = 0.05;         ///< of the landmarks with a depth, lost ones included, as inliers
};

constexpr int kMaximumWindowPairs = 8;  ///< capacity of the window, the newest pair included

/// The window of pairs whose motion is adjusted.
struct WindowSettings {
  int pairs = 7;  ///< less than kMaximumWindowPairs
};

/// Growth of errors over motions (docs/how-it-works.md, section 8).
struct UncertaintySettings {
  double drift_ratio = 0.2;               ///< drift per pair, of a motion's noise, at full image motion
  double drift_correlation_pairs = 40.0;  ///< pairs until e^-1 of the drift is left
};

/// Detection of a standstill: the pose stays within these limits.
struct StandstillSettings {
  double translation = 0.0015;  ///< m
  double rotation = 0.0002;     ///< rad
  double least_time = 0.25;     ///< s, minimum duration
  double motion_significance =
      5.0;  ///< standard deviations; the limits above are as many of a motion at a standstill
};

/// Self-calibration of the rig.
enum class RigRefinement : std::uint8_t {
  off,
  correct,  ///< the calibration error is estimated and corrected
};

/// Conditions of a valid motion.
struct ValiditySettings {
  int minimum_features = 30;                 ///< detected in the left image
  int minimum_matches = 20;                  ///< with a depth, in the current pair and the reference
  int minimum_inliers = 15;                  ///< consistent with the motion
  double minimum_inlier_ratio = 0.3;         ///< inliers / matches
  double maximum_time_step = 1.5;            ///< s between pairs: a lost second does not end an epoch
  double maximum_offset = 0.1;               ///< s between the exposures of a pair
  double maximum_offset_uncertainty = 0.01;  ///< s, standard deviation of the time offset
  double maximum_speed = 50.0;               ///< m/s
  double maximum_rate = 4.0;                 ///< rad/s
};

struct OdometrySettings {
  Estimator estimator = Estimator::reprojection;
  int features = 1000;     ///< target number of features in each left image, 50 to 20000
  std::uint64_t seed = 1;  ///< of the random subsets
  DetectionSettings detection;
  TrackingSettings tracking;
  StereoSettings stereo;
  MotionSettings motion;  ///< `estimator: thesis` only
  HistorySettings history;
  RefinementSettings refinement;    ///< `estimator: thesis` only
  PoseSearchSettings pose_search;   ///< `estimator: reprojection` only
  WindowSettings window;            ///< `estimator: reprojection` only
  UncertaintySettings uncertainty;  ///< `estimator: reprojection` only
  StandstillSettings standstill;    ///< `estimator: reprojection` only
  double unknown_velocity = 3.0;    ///< m/s, stddev before the first motion; `estimator: reprojection` only
  RigRefinement rig_refinement = RigRefinement::correct;  ///< `estimator: reprojection` only
  SelfCalibrationSettings self_calibration;               ///< `estimator: reprojection` only
  ValiditySettings validity;
};

/// Minimum distance between features, px, in an image of `width` x `height` px: tracking.minimum_distance, or
/// half the mean spacing of `features` points if that is less; at least 1.
double minimumDistance(const OdometrySettings& settings, int width, int height);

/// Largest disparity (px) that `estimator: reprojection` searches in images of `width` px: half the width. Of
/// nearer surfaces, only the edges are seen by both cameras.
int nearestDisparity(int width);

/// Throws std::invalid_argument that names the first value out of range and its range, for example
/// "tracking.levels is 0: expected 1 to 8".
void validate(const OdometrySettings& settings);

}  // namespace cartvo::vo
