// The host's clock is monotonic, and near the wall clock.

#include "common/host_clock.hpp"

#include <chrono>

#include <gtest/gtest.h>

namespace cartvo {
namespace {

TEST(HostClock, AdvancesWithMonotonicTimeAndBeginsAsWallClock) {
  const auto monotonic = [] {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
  };
  const std::int64_t before = hostNow() - monotonic();
  const std::int64_t after = hostNow() - monotonic();
  EXPECT_NEAR(static_cast<double>(after - before), 0.0, 50e6);
  const std::int64_t converted = hostTimeOfMonotonic(monotonic());
  EXPECT_LE(converted, hostNow());
  const auto wall = std::chrono::duration_cast<std::chrono::nanoseconds>(
                        std::chrono::system_clock::now().time_since_epoch())
                        .count();
  EXPECT_NEAR(static_cast<double>(wallClockNow() - wall), 0.0, 50e6);
}

}  // namespace
}  // namespace cartvo
