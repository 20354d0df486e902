#pragma once

#include <string>

#include "calib/model/rig.hpp"

namespace cartvo::calib {

// Limits of the values of a rig.
constexpr int kMinImageSide = 16, kMaxImageSide = 8192;         // px
constexpr double kMinBaseline = 0.005, kMaxBaseline = 10.0;     // m
constexpr double kMaxScaleStddev = 0.1;                         // relative
constexpr double kMaxReadout = 0.2;                             // s, magnitude
constexpr double kMinFocalLength = 1.0, kMaxFocalLength = 1e5;  // px

/// Range of a principal point's coordinate along an image side of this length, px.
constexpr double minCentre(int length) {
  return -length;
}
constexpr double maxCentre(int length) {
  return 2.0 * length;
}

/// Throws std::invalid_argument, naming the value, if an image size, focal length, principal point,
/// distortion, readout, mask, rotation or translation is out of range, or the baseline is not within 5 mm to
/// 10 m (a larger one is a calibration in millimetres).
void validateRig(const Rig& rig);

/// Text about values of a valid rig that only an unusual stereo pair on a vehicle has, with the numbers and
/// questions what they may mean instead; empty if there are none. For example a principal point
/// outside the image's middle, focal lengths that differ by more than a quarter, a baseline above 1.5 m,
/// cameras turned against each other by more than 15 degrees.
std::string unusualGeometry(const Rig& rig);

}  // namespace cartvo::calib
