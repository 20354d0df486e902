#pragma once

#include <string>
#include <vector>

#include "tools/benchmark/accuracy/accuracy_benchmark.hpp"

namespace cartvo::benchmark {

/// A variant of the odometry settings in which one part of the method is removed or changed.
struct Ablation {
  const char* name;
  const char* description;  ///< of the change, for help texts and reports
  void (*change)(vo::OdometrySettings& settings);
  bool simultaneous = false;  ///< see OdometryVariant::simultaneous
};

/// All variants. The first one is the unmodified reference.
const std::vector<Ablation>& ablations();
std::vector<std::string> ablationNames();

/// One variant of `full` for each of `names`, in the order of `ablations`. The unmodified reference always
/// comes first, even if `names` does not contain it. `names` must be a subset of `ablationNames`.
std::vector<OdometryVariant> ablatedVariants(const vo::OdometrySettings& full,
                                             const std::vector<std::string>& names);

}  // namespace cartvo::benchmark
