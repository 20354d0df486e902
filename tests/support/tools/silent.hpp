#pragma once

#include "tools/cartvo/work_observer.hpp"

namespace cartvo::test {

/// A work observer that prints nothing.
inline WorkObserver silent() {
  return {[](const WorkStep&) {}, [](int, int) {}};
}

}  // namespace cartvo::test
