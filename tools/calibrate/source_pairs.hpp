#pragma once

#include <functional>

#include "capture/pair_synchroniser.hpp"
#include "capture/stereo_source.hpp"

namespace cartvo::calibrate {

/// Calls `use` with each pair of a source on disk, in order, until it returns false.
void forEachPair(capture::StereoSource& source, const std::function<bool(const capture::FramePair&)>& use);

}  // namespace cartvo::calibrate
