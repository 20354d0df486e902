// Tests of the command line of `cartvo simulate`.
#include <array>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/temporary_folder.hpp"
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

TEST(SimulateCommand, LooksAtItsCacheBeforeRendering) {
  const test::CommandResult run = test::runCartvo("simulate --prepare-only --cache-dir /proc/nope");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.output, ::testing::AllOf(HasSubstr("/proc/nope"), HasSubstr("name another --cache-dir"),
                                           ::testing::Not(HasSubstr("rendering"))));
}

TEST(SimulateCommand, LooksAtItsOutputFolderBeforeRendering) {
  const test::CommandResult run = test::runCartvo("simulate --output-dir /proc/nope");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.output, ::testing::AllOf(HasSubstr("/proc/nope: the folder cannot be created"),
                                           ::testing::Not(HasSubstr("rendering"))));
}

TEST(SimulateCommand, CacheThatCannotBeWrittenIsAWarning) {
  const test::TemporaryFolder folder;
  const test::CommandResult run = test::runCartvo(
      "simulate --cache-dir /proc/nope --size 64x48 --seconds 0.1 --lead-in 0.1 --left 127.0.0.1:0 --right "
      "127.0.0.1:0 --output-dir " +
      folder.path().string());
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_THAT(run.output,
              ::testing::AllOf(HasSubstr("the streams are not cached"), HasSubstr("ready: rtsp://")));
}

}  // namespace
}  // namespace cartvo
