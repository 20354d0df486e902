#pragma once

#include "tools/benchmark/accuracy_benchmark.hpp"

namespace cartvo::test {

/// An observer of long work that says nothing.
inline benchmark::WorkObserver silent() {
  return {[](const std::string&) {}, [](int, int) {}};
}

}  // namespace cartvo::test
