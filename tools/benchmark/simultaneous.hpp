#pragma once

#include <filesystem>

#include "capture/stereo_source.hpp"

namespace cartvo::benchmark {

/// Sets `left` and `right` as the cameras of `source`. Right images get the instants of their left partners,
/// so the odometry assumes simultaneous exposures. Right images without a partner are left out.
void playSimultaneously(StereoSource& source, const ImageSequence& left, const ImageSequence& right);

/// Opens an image folder and plays it simultaneously, see playSimultaneously.
StereoSource openSimultaneous(const std::filesystem::path& folder);

}  // namespace cartvo::benchmark
