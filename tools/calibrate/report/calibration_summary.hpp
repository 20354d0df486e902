#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "calib/solver/calibration.hpp"

namespace cartvo {

/// All results of a calibration as JSON: lengths in m, angles in rad, image distances in px.
nlohmann::ordered_json calibrationJson(const calib::Calibration& calibration);

/// Summary of a calibration for a terminal: rejected views, models compared, the rig, depth errors, checks.
std::string calibrationText(const calib::Calibration& calibration);

/// The value of a check with three digits; "not seen" for an infinite one.
std::string checkValueText(const calib::ValidationCheck& check);

/// "The calibration passes its validation.", with what it leaves uncertain, or that it does not pass.
std::string verdictText(const calib::Calibration& calibration);

/// A depth difference as text. Infinite ones become "not seen".
std::string metresText(double metres);

/// The depth error (m) at a distance (m) if the disparity error equals the RMS of the held-out vertical
/// disparities.
double depthErrorOf(const calib::Calibration& calibration, double distance);

}  // namespace cartvo
