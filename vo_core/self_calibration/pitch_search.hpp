#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "vo_core/tracking/landmark.hpp"

namespace cartvo::vo {

/// Searches the right image for the landmarks' last observations, with the right camera at `pitch` (rad).
using MatchAtPitch = std::function<void(std::vector<Landmark>& landmarks, double pitch)>;

/// Whether so few of the landmarks' last observations have a stereo match that the pitch of the right camera
/// may exceed the range of the search over rows.
bool hasFewMatches(const std::vector<Landmark>& landmarks);

/// Coarse pitch (rad) at which many of a sample of the unmatched landmarks find a match or, in the dark, many
/// times as many of all landmarks as are matched without it. Empty if there is none: then the scene is the
/// cause of the missing matches.
std::optional<double> findPitch(const std::vector<Landmark>& landmarks, double focal_length,
                                const MatchAtPitch& match);

}  // namespace cartvo::vo
