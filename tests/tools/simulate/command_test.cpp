// Tests of the command line of `cartvo simulate`.
#include <array>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/tools/run_cartvo.hpp"

namespace cartvo {
namespace {

using ::testing::HasSubstr;

TEST(SimulateCommand, RejectsInvalidArguments) {
  const std::array<std::pair<const char*, const char*>, 6> invalid{{
      {"--world nowhere", "unknown scenario 'nowhere'; there are: campus"},
      {"--size 680", "'680' is not WIDTHxHEIGHT, such as 680x420"},
      {"--left here", "'here' is not ADDRESS:PORT, such as 127.0.0.1:8554"},
      {"--right 127.0.0.1:99999", "'127.0.0.1:99999' is not ADDRESS:PORT"},
      {"--seconds -1", "--seconds"},
      {"--world campus --sequence folder", "--world excludes --sequence"},
  }};
  for (const auto& [arguments, message] : invalid) {
    const test::CommandResult run = test::runCartvo(std::string("simulate ") + arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments;
    EXPECT_THAT(run.output, HasSubstr(message));
  }
}

}  // namespace
}  // namespace cartvo
