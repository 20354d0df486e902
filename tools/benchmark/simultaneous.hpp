#pragma once

#include <filesystem>

#include "capture/stereo_source.hpp"

namespace cartvo::benchmark {

/// Plays `left` and `right` as the cameras of `source`. The right images get the instants of the left ones
/// that they pair with, so that the odometry takes both cameras as exposed at once. Right images without a
/// partner are left out.
void playSimultaneously(StereoSource& source, const ImageSequence& left, const ImageSequence& right);

/// The image folder, its right images with the instants of the left ones.
StereoSource openSimultaneous(const std::filesystem::path& folder);

}  // namespace cartvo::benchmark
