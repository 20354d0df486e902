// The client and the example controllers over LCM on loopback, in a network namespace of its own.

#include <array>
#include <atomic>
#include <cstdio>
#include <functional>
#include <regex>
#include <string>
#include <thread>

#include <cartvo/client.hpp>
#include <gtest/gtest.h>

#include "support/client/valid_message.hpp"
#include "support/test_timeout.hpp"

namespace cartvo::client {
namespace {

using std::chrono::milliseconds;

/// Publishes messages at 50 Hz until its end.
class Publisher {
 public:
  Publisher() : thread_([this] { run(); }) {}
  ~Publisher() { stop(); }
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  void stop() {
    is_over_ = true;
    if (thread_.joinable()) thread_.join();
  }

 private:
  void run() {
    lcm::LCM lcm(kDefaultLcmUrl);
    for (std::int64_t sequence = 0; !is_over_; ++sequence) {
      odometry_t message = test::validMessage(sequence, nowUtime());
      message.angular_velocity_body[2] = -0.5;
      message = test::sealed(message);
      lcm.publish(kOdometryChannel, &message);
      std::this_thread::sleep_for(milliseconds(20));
    }
  }

  std::atomic<bool> is_over_ = false;
  std::thread thread_;
};

TEST(ClientOverLcm, MeasuresThenRampsThenIsSafe) {
  lcm::LCM lcm(kDefaultLcmUrl);
  ASSERT_TRUE(lcm.good());
  OdometryClient odometry(lcm);
  const auto end = SteadyClock::now() + test::kTestTimeout;
  const auto run_until = [&](const std::function<bool(const ControllerInput&)>& condition) {
    while (SteadyClock::now() < end) {
      odometry.update(10);
      if (condition(odometry.input())) return true;
    }
    return false;
  };
  const auto is_state = [](InputState state) {
    return [state](const ControllerInput& input) { return input.state == state; };
  };
  Publisher publisher;
  EXPECT_TRUE(run_until([](const ControllerInput& input) { return input.authority >= 1.0; }));
  EXPECT_GT(odometry.newest().kept(), 10u);
  publisher.stop();
  EXPECT_TRUE(run_until(is_state(InputState::safe)));  // a cycle that takes long may not see the ramp
}

/// A running program, whose lines are read; ended with the object.
class Program {
 public:
  explicit Program(const std::string& program)
      : pipe_(popen(("exec timeout " + std::to_string(kTimeout_s) + " " + program + " 2>&1").c_str(), "r")) {}
  ~Program() {
    if (pipe_ != nullptr) pclose(pipe_);  // its next line ends it, because the pipe is closed
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// Reads lines until one contains the pattern. Returns whether one did before the program ended.
  bool readUntil(const std::string& pattern) {
    const std::regex wanted(pattern);
    std::array<char, 4096> line{};
    while (pipe_ != nullptr && std::fgets(line.data(), line.size(), pipe_) != nullptr) {
      if (std::regex_search(line.data(), wanted)) return true;
    }
    return false;
  }

 private:
  static constexpr auto kTimeout_s =
      std::chrono::duration_cast<std::chrono::seconds>(test::kTestTimeout).count();

  FILE* pipe_;
};

class ExampleController : public testing::TestWithParam<const char*> {};

TEST_P(ExampleController, UsesOdometryAndEndsInTheSafeCommand) {
  Program controller(GetParam());
  {
    const Publisher publisher;
    EXPECT_TRUE(controller.readUntil("measured +authority 1.00 +command +\\+114.592"));
  }
  EXPECT_TRUE(controller.readUntil("safe +authority 0.00 +command +[+-]0.000"));
}

INSTANTIATE_TEST_SUITE_P(Examples, ExampleController,
                         testing::Values(CARTVO_STEERING_SUBSCRIBER, CARTVO_C_CONTROLLER));

}  // namespace
}  // namespace cartvo::client
