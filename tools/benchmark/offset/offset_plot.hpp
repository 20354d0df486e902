#pragma once

#include <vector>

#include "tools/benchmark/offset/offset_benchmark.hpp"
#include "tools/report/drawing.hpp"

namespace cartvo::benchmark {

/// A drawing of the segment errors of the rendered worlds over the time offset, translation and rotation,
/// logarithmic: a thin line for each world and model, a thick line for all worlds together. Drifting clocks
/// are left out. Throws std::invalid_argument if nothing is left.
Drawing offsetPlot(const std::vector<OffsetAccuracy>& accuracies);

}  // namespace cartvo::benchmark
