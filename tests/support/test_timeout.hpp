#pragma once

#include <chrono>

namespace cartvo::test {

/// Maximum time that a live test waits for an event: far longer than a loaded machine or a sanitizer needs,
/// so that only an event that never happens takes it.
constexpr std::chrono::milliseconds kTestTimeout{45000};

}  // namespace cartvo::test
