#pragma once

#include <filesystem>

#include "capture/stereo_source.hpp"

namespace cartvo::benchmark {

/// Sets `left` and `right` as the cameras of `source`. Right images get the instants of their left partners,
/// so the odometry assumes simultaneous exposures. Right images without a partner are left out.
void playSimultaneously(capture::StereoSource& source, const capture::ImageSequence& left,
                        const capture::ImageSequence& right);

/// Opens an image folder and plays it simultaneously, see playSimultaneously.
capture::StereoSource openSimultaneous(const std::filesystem::path& folder);

}  // namespace cartvo::benchmark
