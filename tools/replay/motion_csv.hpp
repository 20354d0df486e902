#pragma once

#include <string>
#include <vector>

#include "tools/replay/replay.hpp"

namespace cartvo {

/// Text of `Motionestimation.csv`, the thesis' output: one row per pair, in the cart's body axes (x forward,
/// y left, z up), SI units. Columns:
/// - pair, time: index from 0; exposure of the left image, s
/// - valid: 1 if the motion was measured, else 0, and the motion columns are empty
/// - Vx, Vy, Vz: velocity of the body's origin, m/s
/// - pitch_rate, yaw_rate, roll_rate: angular velocity about y, z and x, rad/s
/// - x, y, z, roll, pitch, yaw: pose relative to the first pair, m and rad (R = Rz(yaw) Ry(pitch) Rx(roll))
/// - offset_ms: right minus left exposure
/// - features, tracked, matched, inliers: counts
///
/// `errors`: empty, or for each pair the text of further columns, from TruthEvaluation: error_Vx ...
/// error_roll_rate, estimate minus truth of the columns of that name, and error_position, distance between
/// the estimated and the true position, m; each empty where the truth is unknown.
std::string motionCsv(const Replay& replay, const std::vector<std::string>& errors = {});

}  // namespace cartvo
