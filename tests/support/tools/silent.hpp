#pragma once

#include "tools/benchmark/accuracy/accuracy_benchmark.hpp"

namespace cartvo::test {

/// A work observer that prints nothing.
inline benchmark::WorkObserver silent() {
  return {[](const std::string&, const std::string&) {}, [](int, int) {}};
}

}  // namespace cartvo::test
