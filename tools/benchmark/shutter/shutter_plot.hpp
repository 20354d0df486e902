#pragma once

#include <vector>

#include "tools/benchmark/shutter/shutter_benchmark.hpp"
#include "tools/report/drawing.hpp"

namespace cartvo::benchmark {

/// A drawing, logarithmic, of the segment errors over the readout (both cameras alike, not negative, exposed
/// at the same time, mount at rest), and of the errors of the rates over the frequency of a vibration. A thin
/// line for each world and model, a thick line for all worlds together. Diagrams without curves are left out.
/// Throws std::invalid_argument if none is left.
Drawing shutterPlot(const std::vector<ShutterAccuracy>& accuracies);

}  // namespace cartvo::benchmark
