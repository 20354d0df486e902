#pragma once

#include <string>
#include <vector>

#include "tools/benchmark/accuracy_benchmark.hpp"

namespace cartvo::benchmark {

/// One part of the method left out or done otherwise.
struct Ablation {
  const char* name;
  const char* what;  ///< for people: what is different
  void (*change)(OdometrySettings& settings);
  bool simultaneous = false;  ///< as OdometryVariant's
};

/// The first changes nothing: what the others are compared with.
const std::vector<Ablation>& ablations();
std::vector<std::string> ablationNames();

/// `full` with each of them changed, and the unchanged one first whether named or not. `names` must be of
/// `ablationNames`.
std::vector<OdometryVariant> ablatedVariants(const OdometrySettings& full,
                                             const std::vector<std::string>& names);

}  // namespace cartvo::benchmark
