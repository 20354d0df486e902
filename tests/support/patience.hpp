#pragma once

#include <chrono>

namespace cartvo::test {

/// How long a live test waits for what must come: far longer than any loaded machine or sanitizer needs, so
/// that only what never comes takes it.
constexpr std::chrono::milliseconds kPatience{45000};

}  // namespace cartvo::test
