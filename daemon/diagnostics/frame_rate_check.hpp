#pragma once

#include <optional>
#include <string>

#include "pipeline/frame_periods.hpp"

namespace cartvo::daemon {

/// The problem of the cameras' frame rates, as measured: they differ from each other or from the configured
/// rate (Hz) by a tenth or more, by the exposures and by the arrivals: the former may be rounded, the latter
/// lack frames that were lost. Empty if there is none.
std::string frameRateProblem(const pipeline::FramePeriods& periods, std::optional<double> configured);

}  // namespace cartvo::daemon
