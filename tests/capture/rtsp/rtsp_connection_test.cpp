// Failure and recovery of a live connection, over real sockets on loopback, from the simulated camera.

#include <atomic>
#include <cerrno>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "capture/rtsp/rtsp_camera.hpp"
#include "tests/support/capture/live_camera.hpp"
#include "tests/support/capture/silent_server.hpp"
#include "tests/support/capture/tcp_proxy.hpp"
#include "tests/support/closed_port.hpp"

namespace cartvo::capture {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::Not;

bool readUntilState(RtspCamera& camera, CameraState state) {
  return test::readUntil(camera, [&](ReadOutcome, const Frame&) { return camera.health().state == state; });
}

TEST(RtspConnection, ReportsWrongPasswordWithoutShowingIt) {
  testing::internal::CaptureStderr();  // FFmpeg would print the URL to it
  const auto server = test::startCamera(test::leftStream());
  RtspCameraSettings settings = test::settingsFor(server->port());
  settings.credentials.password = "hunter2";
  RtspCamera camera(settings);
  EXPECT_TRUE(readUntilState(camera, CameraState::refused));
  const CameraHealth health = camera.health();
  const std::string printed = testing::internal::GetCapturedStderr();
  EXPECT_THAT(health.last_error, HasSubstr("refused the user or password (user 'admin')"));
  EXPECT_THAT(health.last_error, HasSubstr("; trying again in 30 s"));
  EXPECT_THAT(health.last_error, Not(HasSubstr("hunter2")));
  EXPECT_THAT(printed, Not(HasSubstr("hunter2")));
  // No quick retry: the camera would lock the account.
  Frame frame;
  EXPECT_EQ(camera.read(frame, milliseconds(300)), ReadOutcome::timed_out);
  EXPECT_EQ(camera.health().state, CameraState::refused);
}

TEST(RtspConnection, WaitsAsLongAsTheCameraHasLockedTheLogin) {
  const auto server = test::startCamera(test::leftStream());
  RtspCameraSettings settings = test::settingsFor(server->port());
  settings.credentials.password = "hunter2";
  settings.refused_retry = milliseconds(1);
  settings.longest_refused_retry = milliseconds(1);
  int questions = 0;
  settings.ask_about_refusal = [&](const std::atomic<bool>& interrupted) {
    EXPECT_FALSE(interrupted);
    ++questions;
    return RefusedLogin{std::chrono::seconds(1799), "the camera has locked this login"};
  };
  RtspCamera camera(settings);
  EXPECT_TRUE(readUntilState(camera, CameraState::refused));
  EXPECT_THAT(camera.health().last_error,
              HasSubstr("; the camera has locked this login; trying again in 1800 s"));
  Frame frame;
  EXPECT_EQ(camera.read(frame, milliseconds(50)), ReadOutcome::timed_out);
  EXPECT_EQ(questions, 1);
}

TEST(RtspConnection, IsNeverHurriedByAStatedLock) {
  const auto server = test::startCamera(test::leftStream());
  RtspCameraSettings settings = test::settingsFor(server->port());
  settings.credentials.password = "hunter2";
  const std::pair<std::optional<milliseconds>, std::string> pauses[]{
      {std::nullopt, "30 s"},
      {milliseconds(0), "30 s"},
      {std::chrono::seconds(5), "30 s"},
      {std::chrono::seconds(60), "61 s"},
      {std::chrono::hours(24), "7200 s"},
      {std::chrono::seconds(1'000'000'000), "7200 s"}};
  for (const auto& [locked_for, pause] : pauses) {
    settings.ask_about_refusal = [lock = locked_for](const std::atomic<bool>&) {
      return RefusedLogin{lock, {}};
    };
    RtspCamera camera(settings);
    EXPECT_TRUE(readUntilState(camera, CameraState::refused));
    EXPECT_THAT(camera.health().last_error, testing::EndsWith("; trying again in " + pause));
  }
}

TEST(RtspConnection, ReportsMissingPassword) {
  const auto server = test::startCamera(test::leftStream());
  RtspCameraSettings settings = test::settingsFor(server->port());
  settings.credentials = {};
  RtspCamera camera(settings);
  EXPECT_TRUE(readUntilState(camera, CameraState::refused));
  EXPECT_THAT(camera.health().last_error, HasSubstr("requires a user and password, and none are configured"));
}

TEST(RtspConnection, ReconnectsAfterCameraRestart) {
  auto server = test::startCamera(test::leftStream());
  const std::uint16_t port = server->port();
  RtspCamera camera(test::settingsFor(port));
  Frame frame;
  ASSERT_TRUE(test::readFrames(camera, 10));
  server.reset();
  ASSERT_TRUE(test::readUntil(
      camera, [&](ReadOutcome, const Frame&) { return camera.health().state != CameraState::streaming; }));
  EXPECT_THAT(camera.health().last_error, HasSubstr("127.0.0.1:" + std::to_string(port)));
  server = test::startCamera(test::leftStream(), port);
  EXPECT_TRUE(test::readFrames(camera, 10));
  EXPECT_EQ(camera.health().state, CameraState::streaming);
  EXPECT_EQ(camera.health().reconnections, 1U);
}

TEST(RtspConnection, ReconnectsAfterStall) {
  const auto server = test::startCamera(test::leftStream());
  test::TcpProxy proxy(server->port());
  RtspCameraSettings settings = test::settingsFor(proxy.port());
  settings.stall_timeout = milliseconds(300);
  RtspCamera camera(settings);
  ASSERT_TRUE(test::readFrames(camera, 10));
  proxy.stall();
  ASSERT_TRUE(readUntilState(camera, CameraState::stalled));
  EXPECT_THAT(camera.health().last_error, HasSubstr("sent no picture for 300 ms"));
  EXPECT_TRUE(test::readFrames(camera, 5));
}

TEST(RtspConnection, ReportsClosedPort) {
  const test::ClosedPort closed;
  RtspCamera camera(test::settingsFor(closed.port()));
  Frame frame;
  EXPECT_EQ(camera.read(frame, milliseconds(200)), ReadOutcome::timed_out);
  EXPECT_THAT(camera.health().last_error, HasSubstr("Connection refused"));
  EXPECT_EQ(camera.health().state, CameraState::connecting);
}

TEST(RtspConnection, ReportsServerThatDoesNotAnswer) {
  const test::SilentServer server(1);
  RtspCameraSettings settings = test::settingsFor(server.port());
  settings.connect_timeout = milliseconds(300);
  RtspCamera camera(settings);
  Frame frame;
  EXPECT_EQ(camera.read(frame, milliseconds(100)), ReadOutcome::timed_out);
  EXPECT_THAT(camera.health().last_error, HasSubstr("no answer from the camera at 127.0.0.1"));
  EXPECT_THAT(camera.health().last_error, HasSubstr("within 300 ms"));
}

TEST(RtspConnection, ReportsServerThatDoesNotAcceptConnections) {
  const test::SilentServer server(0);
  const auto* const address = reinterpret_cast<const sockaddr*>(&server.address());
  std::vector<int> waiting;  // until the kernel accepts no further connection
  for (int i = 0; i < 4; ++i) {
    waiting.push_back(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK, 0));
    EXPECT_TRUE(::connect(waiting.back(), address, sizeof server.address()) == 0 || errno == EINPROGRESS);
  }
  RtspCameraSettings settings = test::settingsFor(server.port());
  settings.answer_timeout = milliseconds(200);
  RtspCamera camera(settings);
  Frame frame;
  EXPECT_EQ(camera.read(frame, milliseconds(100)), ReadOutcome::timed_out);
  EXPECT_THAT(camera.health().last_error, HasSubstr("Connection timed out"));
  for (const int socket : waiting)
    ::close(socket);
}

TEST(RtspConnection, InterruptEndsReadingInEachState) {
  const auto server = test::startCamera(test::leftStream());
  test::TcpProxy proxy(server->port());
  // A proxy that was stalled before the connection accepts it and never answers.
  for (const bool answers : {true, false}) {
    RtspCamera camera(test::settingsFor(proxy.port()));
    if (!answers) proxy.stall();
    std::atomic<bool> ended = false;
    std::thread reader([&] {
      Frame frame;
      while (camera.read(frame, milliseconds(10000)) != ReadOutcome::ended)
        continue;
      ended = true;
    });
    std::this_thread::sleep_for(milliseconds(300));
    EXPECT_FALSE(ended);
    camera.interrupt();
    reader.join();
    EXPECT_EQ(camera.health().state, CameraState::ended);
    Frame frame;
    EXPECT_EQ(camera.read(frame, milliseconds(1000)), ReadOutcome::ended);
  }
}

}  // namespace
}  // namespace cartvo::capture
