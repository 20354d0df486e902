// Signals during long work that writes files: nothing half written is left.
#include <csignal>
#include <filesystem>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/doctor/walls.hpp"
#include "support/temporary_folder.hpp"
#include "support/tools/piped_cartvo.hpp"

namespace cartvo {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr int kAfterSigint = 128 + SIGINT, kAfterSighup = 128 + SIGHUP;

class Interruptions : public testing::Test {
 protected:
  void SetUp() override {
    constexpr int kRounds = 2;
    test::recordWalls(folder_ / "drive", kRounds);
  }

  /// Runs a command, sends a signal after a line of its progress with `part`, and waits for its end.
  test::CommandResult interrupt(const std::string& arguments, const std::string& part, int signal) {
    test::PipedCartvo cartvo(arguments);
    EXPECT_NE(cartvo.awaitLine(part), "") << arguments;
    cartvo.send(signal);
    return cartvo.finish();
  }

  /// Names in the folder.
  std::set<std::string> names() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      names.insert(entry.path().filename());
    return names;
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  test::TemporaryFolder folder_;
};

TEST_F(Interruptions, OfATrimLeaveNothing) {
  const test::CommandResult run =
      interrupt("recording trim " + path("drive") + " --output-dir " + path("part"), "pictures", SIGINT);
  EXPECT_EQ(run.exit_code, kAfterSigint);
  EXPECT_THAT(run.output, HasSubstr("cartvo: interrupted; nothing was written"));
  EXPECT_THAT(names(), ElementsAre("drive"));
}

TEST_F(Interruptions, OfATrimLeaveAnEmptyFolderThatWasThere) {
  std::filesystem::create_directory(folder_ / "part");
  const test::CommandResult run =
      interrupt("recording trim " + path("drive") + " --output-dir " + path("part"), "pictures", SIGHUP);
  EXPECT_EQ(run.exit_code, kAfterSighup);
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "part"));
}

TEST_F(Interruptions, ThatTheCallerIgnoresStayIgnored) {
  std::signal(SIGHUP, SIG_IGN);  // as nohup does
  const test::CommandResult run =
      interrupt("recording trim " + path("drive") + " --output-dir " + path("part"), "pictures", SIGHUP);
  std::signal(SIGHUP, SIG_DFL);
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.output, Not(HasSubstr("interrupted")));
  EXPECT_THAT(names(), ElementsAre("drive", "part"));
}

TEST_F(Interruptions, OfAnExportLeaveNothing) {
  for (const std::string part : {"pairs", "pictures"}) {
    for (const std::string format : {"mcap", "rosbag2-mcap"}) {
      if (part == "pairs" && format != "mcap") continue;
      const test::CommandResult run = interrupt(
          "export " + path("drive") + " --format " + format + " --output " + path("new/drive"), part, SIGINT);
      EXPECT_EQ(run.exit_code, kAfterSigint) << format << ", " << part;
      EXPECT_THAT(run.output, HasSubstr("cartvo: interrupted; nothing was written"));
      EXPECT_THAT(names(), ElementsAre("drive")) << format << ", " << part;
    }
  }
}

TEST_F(Interruptions, OfRenderingLeaveNothing) {
  const test::CommandResult run = interrupt(
      "simulate --render --size 64x48 --seconds 100 --output-dir " + path("new/images"), "pairs", SIGINT);
  EXPECT_EQ(run.exit_code, kAfterSigint);
  EXPECT_THAT(run.output, HasSubstr("cartvo: interrupted; nothing was written"));
  EXPECT_THAT(names(), ElementsAre("drive"));
}

}  // namespace
}  // namespace cartvo
