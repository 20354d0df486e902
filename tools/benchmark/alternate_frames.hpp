#pragma once

#include <filesystem>

#include "capture/stereo_source.hpp"
#include "tools/benchmark/sequence.hpp"

namespace cartvo::benchmark {

/// Which of the right camera's images go with every second one of the left camera.
enum class RightFrames : std::uint8_t {
  same,  ///< those of the same instants: synchronous pairs at half the rate
  next,  ///< those between: pairs that are one whole frame period apart
};

/// An image folder (both cameras exposed at once) at half its rate; `simultaneous`: the right images with the
/// instants of the left ones.
StereoSource openAlternate(const std::filesystem::path& folder, RightFrames right, bool simultaneous);

/// Every second pose of the truth: those of the left images that are left.
SequenceTruth alternate(const SequenceTruth& truth);

}  // namespace cartvo::benchmark
