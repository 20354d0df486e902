#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "calib/rectification/rectification.hpp"
#include "tools/calibrate/check/rectified_matches.hpp"

namespace cartvo::calibrate {

/// Statistics of matched points that show whether a rig is correct: in rectified images a point must be in
/// the same row of both.
struct RowCheck {
  int pairs = 0;
  int matches = 0;        ///< number of inliers
  double outliers = 0.0;  ///< share of outliers: mismatches and moving objects
  // Vertical disparities of the inliers, px.
  double rms = 0.0, p95 = 0.0;  ///< RMS and 95th percentile of their magnitude
  double median = 0.0;
  double slope = 0.0;    ///< change over the image width, caused by a roll of the right camera
  double scatter = 0.0;  ///< RMS after a rotation of the right camera is fitted: mostly matching noise
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();  ///< that rotation: about x (pitch), y (yaw), z (roll), rad
  /// Standard deviations of `turn`, rad. Errors of lenses are alike in all matches: they count as one.
  Eigen::Vector3d turn_stddev = Eigen::Vector3d::Zero();
  double in_front = 0.0;  ///< share of the inliers without clearly negative disparity
};

/// Computes the statistics of the matches of `pairs` pairs. Throws std::runtime_error if there are too few.
RowCheck checkRows(const std::vector<RectifiedMatch>& matches, int pairs,
                   const calib::Rectification& rectification);

/// Whether most disparities are negative, as with exchanged images.
bool seemsSwapped(const RowCheck& check);

/// Whether a small rotation of the right camera, which the odometry corrects while driving, explains rows
/// that differ by more than `max_rms` px: at most 0.1 degrees of pitch and roll and 0.9 of yaw (with
/// tangential distortion, which looks alike), and an RMS of at most `max_rms` after it.
bool isSlightlyTurned(const RowCheck& check, double max_rms);

/// Whether the rig passes: images not exchanged, and an RMS of at most `max_rms` px, or isSlightlyTurned.
bool passes(const RowCheck& check, double max_rms);

/// A check and the one of the same images with left and right exchanged, if the first fails and the second
/// could be made.
struct RowChecks {
  RowCheck check;
  std::optional<RowCheck> exchanged;
  Contradictions contradictions{};  ///< of the first one

  /// Whether the first one fails only by matches that may be shifted along a pattern that repeats itself.
  bool cannotTell(double max_rms) const {
    return !passes(check, max_rms) && contradictions.areOfARepeatedPattern();
  }

  /// Whether the images are exchanged: most disparities are negative, or only the exchanged images pass.
  bool areExchanged(double max_rms) const;
};

/// The statistics as text, with the depth error if the rows' error were along the row, and the verdict.
std::string rowCheckText(const RowChecks& checks, const calib::Rectification& rectification, double max_rms);

/// The same as JSON.
nlohmann::ordered_json rowCheckJson(const RowChecks& checks, const calib::Rectification& rectification,
                                    double max_rms);

}  // namespace cartvo::calibrate
