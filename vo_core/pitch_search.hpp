#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "vo_core/landmark.hpp"

namespace cartvo {

/// Looks for the landmarks' last sightings in the right image, turned by so much pitch, rad.
using MatchAtPitch = std::function<void(std::vector<Landmark>& landmarks, double pitch)>;

/// Whether so few of the landmarks' last sightings have a match in the right image that the right camera may
/// have been bumped up or down by more than the search looks for.
bool hardlyMatched(const std::vector<Landmark>& landmarks);

/// The pitch, rad, roughly, at which many of a sample of the unmatched find a match or, in the dark, far more
/// of them all than are matched without it. Nothing if there is none: then the scene is to blame.
std::optional<double> findPitch(const std::vector<Landmark>& landmarks, double focal_length,
                                const MatchAtPitch& match);

}  // namespace cartvo
