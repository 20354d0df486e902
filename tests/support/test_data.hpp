#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "support/places.hpp"

namespace cartvo::test {

/// The folder of the real sequences: $CARTVO_DATA, or ../shared/data beside the checkout.
inline std::filesystem::path dataFolder() {
  const char* configured = std::getenv("CARTVO_DATA");
  return configured != nullptr ? std::filesystem::path(configured) : sourceFolder() / "../shared/data";
}

/// Whether missing data fails a test (CI) instead of skipping it.
inline bool dataRequired() {
  const char* required = std::getenv("CARTVO_REQUIRE_DATA");
  return required != nullptr && std::string(required) == "1";
}

}  // namespace cartvo::test

/// Defines `variable` as the path of a data set. If it is missing, skips the test, or fails it with
/// CARTVO_REQUIRE_DATA=1.
#define CARTVO_NEEDS_DATA(variable, name)                                     \
  const std::filesystem::path variable = cartvo::test::dataFolder() / (name); \
  if (!std::filesystem::exists(variable)) {                                   \
    if (cartvo::test::dataRequired()) FAIL() << variable << " is missing";    \
    GTEST_SKIP() << variable << " is not on this machine";                    \
  }
