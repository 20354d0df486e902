#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "vo_core/tracking/landmark.hpp"

// Coarse search for the pitch of the right camera, at which stereo matches are found again.

namespace cartvo::vo {

/// Searches the right image for the landmarks' last observations, with the right camera at `pitch` (rad).
using MatchAtPitch = std::function<void(std::vector<Landmark>& landmarks, double pitch)>;

/// Largest difference of the true pitch from the one that findPitch finds by its matches, rad: the range of
/// the search over rows.
double pitchSearchRange(double focal_length);

/// Whether so few of the landmarks' last observations have a stereo match that the pitch of the right camera
/// may exceed the range of the search over rows.
bool hasFewMatches(const std::vector<Landmark>& landmarks);

/// Searches for the pitch (rad) of the right camera. Accepts a pitch at which many of a sample of the
/// unmatched landmarks find a match or, in the dark, at which many times as many of all landmarks match as
/// without it. Returns nothing if there is none: then the scene is the cause of the missing matches.
std::optional<double> findPitch(const std::vector<Landmark>& landmarks, double focal_length,
                                const MatchAtPitch& match);

}  // namespace cartvo::vo
