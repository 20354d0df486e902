#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "support/places.hpp"

namespace cartvo::test {

/// Where the real sequences lie: $CARTVO_DATA, or ../shared/data beside the checkout.
inline std::filesystem::path dataFolder() {
  const char* configured = std::getenv("CARTVO_DATA");
  return configured != nullptr ? std::filesystem::path(configured) : sourceFolder() / "../shared/data";
}

/// Whether a missing file is a failure (CI) or a reason to skip (a user's machine).
inline bool dataRequired() {
  const char* required = std::getenv("CARTVO_REQUIRE_DATA");
  return required != nullptr && std::string(required) == "1";
}

}  // namespace cartvo::test

/// Sets `variable` to the path of a data set, or skips the test (fails it where CARTVO_REQUIRE_DATA=1).
#define CARTVO_NEEDS_DATA(variable, name)                                     \
  const std::filesystem::path variable = cartvo::test::dataFolder() / (name); \
  if (!std::filesystem::exists(variable)) {                                   \
    if (cartvo::test::dataRequired()) FAIL() << variable << " is missing";    \
    GTEST_SKIP() << variable << " is not on this machine";                    \
  }
