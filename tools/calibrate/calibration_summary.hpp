#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "calib/calibration.hpp"

namespace cartvo {

/// All numbers of a calibration: lengths in m, angles in rad, image distances in px.
nlohmann::ordered_json calibrationJson(const Calibration& calibration);

/// What a person wants to read in a terminal: models tried, the rig with its uncertainty, what was rejected,
/// each check, depth errors.
std::string calibrationText(const Calibration& calibration);

/// A depth's difference as text; infinite ones are those of points that were not seen.
std::string metresText(double metres);

/// The error of depth that the held-out vertical disparity's RMS means if disparities are as far off, m.
double depthErrorOf(const Calibration& calibration, double distance);

}  // namespace cartvo
