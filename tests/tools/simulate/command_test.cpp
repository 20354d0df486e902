// Tests of the command line of `cartvo simulate`.
#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "calib/format/rig_file.hpp"
#include "support/temporary_folder.hpp"
#include "support/tools/run_cartvo.hpp"

namespace cartvo {
namespace {

using ::testing::HasSubstr;

TEST(SimulateCommand, RejectsInvalidArguments) {
  const std::array<std::pair<const char*, const char*>, 14> invalid{{
      {"--world nowhere", "unknown scenario 'nowhere'; there are: campus"},
      {"--size 680", "'680' is not WIDTHxHEIGHT, such as 680x420"},
      {"--left-address here", "'here' is not ADDRESS:PORT, such as 127.0.0.1:8554"},
      {"--right-address 127.0.0.1:99999", "'127.0.0.1:99999' is not ADDRESS:PORT"},
      {"--seconds -1", "--seconds"},
      {"--readout-ms 32,", "'32,' is not the readout of both cameras or LEFT,RIGHT in ms"},
      {"--readout-ms 320", "'320' is not the readout of both cameras or LEFT,RIGHT in ms"},
      {"--shake-degrees 0.3", "--shake-degrees requires --shake-hz"},
      {"--sequence folder --readout-ms 32", "--sequence excludes --readout-ms"},
      {"--sequence folder --start-at 3", "--sequence excludes --start-at"},
      {"--liveliness 2", "--liveliness"},
      {"--world campus --sequence folder", "--world excludes --sequence"},
      {"--recording folder --offset-ms 3", "--recording excludes --offset-ms"},
      {"--recording folder --world campus", "--world excludes --recording"},
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

TEST(SimulateCommand, LooksAtItsPasswordAndAddressesBeforeRendering) {
  const test::TemporaryFolder folder;
  const std::string simulate =
      "simulate --world campus --no-cache --output-dir " + (folder.path() / "out").string();
  const auto refuses = [&](const std::string& options, const std::string& message) {
    const test::CommandResult run = test::runCartvo(simulate + " " + options);
    EXPECT_EQ(run.exit_code, 1) << options;
    EXPECT_THAT(run.output, ::testing::AllOf(HasSubstr(message), ::testing::Not(HasSubstr("rendering"))));
  };
  refuses("--password-file /none", "/none: cannot be read");
  refuses("--left-address 192.0.2.1:8554", "cannot listen on 192.0.2.1:8554");
  refuses("--left-address 127.0.0.1:48554 --right-address 127.0.0.1:48554",
          "cannot listen on 127.0.0.1:48554");
}

/// The folder of a rendered drive of 0.25 s at 8 Hz.
nlohmann::json renderedRig(const std::string& options, const test::TemporaryFolder& folder) {
  const std::string images = (folder.path() / "images").string();
  const test::CommandResult run = test::runCartvo(
      "simulate --size 64x48 --seconds 0.25 --frame-rate 8 --render --output-dir " + images + " " + options);
  EXPECT_EQ(run.exit_code, 0) << run.output;
  const calib::Rig rig = calib::readRig(folder.path() / "images" / "rig.yaml");
  std::ifstream left(folder.path() / "images" / "times_0.txt");
  std::ifstream right(folder.path() / "images" / "times_1.txt");
  double left_time = 0.0, right_time = 0.0;
  left >> left_time;
  right >> right_time;
  return {{"readouts", {rig.left.readout.value_or(-1.0), rig.right.readout.value_or(-1.0)}},
          {"offset", right_time - left_time}};
}

TEST(SimulateCommand, RendersWhatUsersCamerasDo) {
  const test::TemporaryFolder folder;
  const nlohmann::json usual = renderedRig("", folder);
  EXPECT_NEAR(usual["readouts"][0], 0.032, 1e-9);
  EXPECT_NEAR(usual["readouts"][1], 0.032, 1e-9);
  EXPECT_NEAR(usual["offset"], -0.25 / 8.0, 1e-6) << "the cameras run free";
}

TEST(SimulateCommand, RendersTheTimingThatIsWanted) {
  const test::TemporaryFolder folder;
  const nlohmann::json wanted = renderedRig("--offset-ms 12 --readout-ms 0,-30.5", folder);
  EXPECT_NEAR(wanted["readouts"][0], 0.0, 1e-9);
  EXPECT_NEAR(wanted["readouts"][1], -0.0305, 1e-9);
  EXPECT_NEAR(wanted["offset"], 0.012, 1e-6);
}

TEST(SimulateCommand, KeepsARenderedDriveInItsCache) {
  const test::TemporaryFolder folder;
  const std::string cached =
      "simulate --size 64x48 --seconds 0.25 --frame-rate 8 --prepare-only --cache-dir " +
      (folder / "cache").string() + " --bitrate-kbps ";
  EXPECT_THAT(test::runCartvo(cached + "300").output, HasSubstr("rendering"));
  const test::CommandResult again = test::runCartvo(cached + "400");
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_THAT(again.output, ::testing::AllOf(HasSubstr("encoding"), ::testing::Not(HasSubstr("rendering"))));
  EXPECT_THAT(test::runCartvo(cached + "400").output, HasSubstr("streams: cached in"));
}

TEST(SimulateCommand, SaysWhatProvidesAMissingRenderer) {
  const test::TemporaryFolder folder;  // the programs alone
  const std::filesystem::path command = "libexec/cartvo/cartvo-simulate";
  std::filesystem::create_directories(folder / command.parent_path());
  std::filesystem::create_directory(folder / "bin");
  std::filesystem::copy_file(test::cartvoProgram().parent_path().parent_path() / command, folder / command);
  std::filesystem::copy_file(test::cartvoProgram(), folder / "bin/cartvo");
  const test::CommandResult run = test::runCommand("PATH=/nowhere " + (folder / "bin/cartvo").string() +
                                                   " simulate --world turns --prepare-only 2>&1");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.output, HasSubstr("install the package cartvo-lab, or build the target cartvo-render"));
}

TEST(SimulateCommand, CacheThatCannotBeWrittenIsAWarning) {
  const test::TemporaryFolder folder;
  const test::CommandResult run = test::runCartvo(
      "simulate --cache-dir /proc/nope --size 64x48 --seconds 0.1 --lead-in 0.1 --left-address 127.0.0.1:0 "
      "--right-address 127.0.0.1:0 --output-dir " +
      folder.path().string());
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_THAT(run.output,
              ::testing::AllOf(HasSubstr("the streams are not cached"), HasSubstr("ready: rtsp://")));
}

}  // namespace
}  // namespace cartvo
