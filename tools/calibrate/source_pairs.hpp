#pragma once

#include <functional>

#include "capture/pair_synchroniser.hpp"
#include "capture/stereo_source.hpp"

namespace cartvo::calibrate {

/// Hands over each pair of a source on disk, in order, until `use` returns false.
void forEachPair(StereoSource& source, const std::function<bool(const FramePair&)>& use);

}  // namespace cartvo::calibrate
