#pragma once

#include <string>
#include <vector>

#include "tools/benchmark/offset_benchmark.hpp"

namespace cartvo::benchmark {

/// Segment errors of the worlds over the offset, translation and rotation, logarithmic, as SVG: a thin line
/// for each world and model, a thick one for all worlds together. Clocks that drift are left out. Throws
/// std::invalid_argument if nothing is left.
std::string offsetPlot(const std::vector<OffsetAccuracy>& accuracies);

}  // namespace cartvo::benchmark
