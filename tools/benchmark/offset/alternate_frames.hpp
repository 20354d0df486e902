#pragma once

#include <filesystem>

#include "capture/stereo_source.hpp"
#include "tools/benchmark/sequence.hpp"

namespace cartvo::benchmark {

/// The right images that are paired with every second left image.
enum class RightFrames : std::uint8_t {
  same,  ///< at the same instants: synchronised pairs at half the rate
  next,  ///< the images in between: a time offset of one original frame period
};

/// Opens an image folder of synchronised cameras at half its rate. `simultaneous` gives the right images the
/// instants of the left ones.
capture::StereoSource openAlternate(const std::filesystem::path& folder, RightFrames right,
                                    bool simultaneous);

/// Every second pose of the truth, those of the left images that openAlternate plays.
SequenceTruth alternate(const SequenceTruth& truth);

}  // namespace cartvo::benchmark
