// Tests of the simulated camera pair: endpoints, password file and the common start of the content.
#include "tools/simulate/server/camera_pair_simulation.hpp"

#include <chrono>
#include <fstream>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "capture/rtsp/password_file.hpp"
#include "support/pattern_content.hpp"
#include "support/temporary_folder.hpp"
#include "tools/simulate/server/generated_password.hpp"
#include "tools/simulate/stream/encode_content.hpp"

namespace cartvo::simulate {
namespace {

namespace fs = std::filesystem;

TEST(Endpoint, ParsesAddressAndPort) {
  const Endpoint endpoint = parseEndpoint("127.0.0.2:8555");
  EXPECT_EQ(endpoint.address, "127.0.0.2");
  EXPECT_EQ(endpoint.port, 8555);
  for (const char* text :
       {"", "8554", ":8554", "127.0.0.1:", "127.0.0.1:port", "127.0.0.1:70000", "127.0.0.1:1 "}) {
    EXPECT_THROW(parseEndpoint(text), std::invalid_argument) << text;
  }
}

TEST(GeneratedPassword, IsCreatedOnceAndReadableByOwnerOnly) {
  const test::TemporaryFolder folder;
  const std::string password = ensurePassword(folder / "password");
  EXPECT_GE(password.size(), 20U);
  EXPECT_EQ(fs::status(folder / "password").permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(ensurePassword(folder / "password"), password);
  EXPECT_EQ(capture::readPasswordFile(folder / "password"), password);
}

TEST(GeneratedPassword, ReplacesPasswordThatOthersCanRead) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "password") << "known to all\n";
  fs::permissions(folder / "password", fs::perms::others_read, fs::perm_options::add);
  EXPECT_NE(ensurePassword(folder / "password"), "known to all");
}

TEST(GeneratedPassword, ErrorNamesFileThatCannotBeWritten) {
  const test::TemporaryFolder folder;
  try {
    ensurePassword(folder / "no folder/password");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("no folder/password: the password cannot be written"),
              std::string::npos);
  }
}

class CameraPairSimulationTest : public testing::Test {
 protected:
  static CameraPairSettings settings() {
    CameraPairSettings settings;
    settings.left.port = settings.right.port = 0;
    settings.password = "test";
    settings.lead_in = std::chrono::milliseconds(200);
    return settings;
  }
  static std::shared_ptr<const EncodedPair> streams() {
    static const auto kStreams = std::make_shared<const EncodedPair>(
        encodeContent(test::PatternContent(test::PatternSettings{}), EncoderSettings{}, [](int, int) {}));
    return kStreams;
  }
};

TEST_F(CameraPairSimulationTest, StartsContentOneLeadInAfterBeingSwitchedOn) {
  CameraPairSimulation simulation(streams(), settings());
  EXPECT_NE(simulation.left().port(), simulation.right().port());
  const std::int64_t now =
      std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
  simulation.update();
  ASSERT_TRUE(simulation.epoch());
  EXPECT_GE(*simulation.epoch() - now, 200'000'000);
  const std::int64_t epoch = *simulation.epoch();
  simulation.update();
  EXPECT_EQ(simulation.epoch(), epoch) << "the epoch is set only once";
}

TEST_F(CameraPairSimulationTest, WaitsForClientsWithStartWhenWatched) {
  CameraPairSettings waiting = settings();
  waiting.start = ContentStart::when_watched;
  CameraPairSimulation simulation(streams(), waiting);
  simulation.update();
  EXPECT_FALSE(simulation.epoch());
  EXPECT_FALSE(simulation.isFinished());
}

TEST_F(CameraPairSimulationTest, CanBeDestroyedImmediately) {
  for (int i = 0; i < 50; ++i) {
    const CameraPairSimulation simulation(streams(), settings());
  }
}

TEST_F(CameraPairSimulationTest, ErrorNamesPortInUse) {
  const CameraPairSimulation first(streams(), settings());
  CameraPairSettings same = settings();
  same.left.port = first.left().port();
  try {
    const CameraPairSimulation second(streams(), same);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find(std::to_string(same.left.port)), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace cartvo::simulate
