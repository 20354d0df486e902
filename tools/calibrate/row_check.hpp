#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "calib/rectification.hpp"
#include "tools/calibrate/rectified_matches.hpp"

namespace cartvo::calibrate {

/// What matched points say of a rig: in rectified images each point must lie in one row of both.
struct RowCheck {
  int pairs = 0;
  int matches = 0;        ///< that agree with each other
  double outliers = 0.0;  ///< share of the matches that do not: mismatches, things that moved
  // Vertical disparities of the matches that agree, px.
  double rms = 0.0, p95 = 0.0, median = 0.0;  ///< the first two of their magnitude
  double slope = 0.0;  ///< their change over the image's width: a right camera that is rolled
  double scatter =
      0.0;  ///< RMS of what no tilt of the right camera explains: mostly the matching's own noise
  double in_front = 0.0;  ///< share of the matches that are not clearly behind infinity
};

/// Sums up matches of `pairs` pairs. Throws std::runtime_error if there are too few to say anything.
RowCheck checkRows(const std::vector<RectifiedMatch>& matches, int pairs, const Rectification& rectification);

/// Whether most matches lie behind infinity, as they do where the two images are exchanged.
bool seemsSwapped(const RowCheck& check);

/// Whether the rig fits: not exchanged, and an RMS of at most `largest_rms` px.
bool passes(const RowCheck& check, double largest_rms);

/// For people: the figures, what they mean, and what such an error along the rows does to the depth.
std::string rowCheckText(const RowCheck& check, const Rectification& rectification, double largest_rms);

nlohmann::ordered_json rowCheckJson(const RowCheck& check, const Rectification& rectification,
                                    double largest_rms);

}  // namespace cartvo::calibrate
