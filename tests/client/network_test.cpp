// The client and the example controllers over LCM on loopback, in a network namespace of its own.

#include <array>
#include <atomic>
#include <cstdio>
#include <functional>
#include <future>
#include <string>
#include <thread>

#include <cartvo/client.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/client/valid_message.hpp"
#include "support/test_timeout.hpp"

namespace cartvo::client {
namespace {

using std::chrono::milliseconds;
using testing::ContainsRegex;

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
  EXPECT_TRUE(run_until(is_state(InputState::ramping)));
  EXPECT_TRUE(run_until(is_state(InputState::safe)));
}

/// Output of a program that is ended after `seconds`.
std::string outputOf(const std::string& program, int seconds) {
  FILE* pipe = popen(("timeout " + std::to_string(seconds) + " " + program + " 2>&1").c_str(), "r");
  std::string output;
  std::array<char, 4096> part{};
  while (pipe != nullptr && std::fgets(part.data(), part.size(), pipe) != nullptr)
    output += part.data();
  if (pipe != nullptr) pclose(pipe);
  return output;
}

class ExampleController : public testing::TestWithParam<const char*> {};

TEST_P(ExampleController, UsesOdometryAndEndsInTheSafeCommand) {
  auto output = std::async(std::launch::async, outputOf, GetParam(), 5);
  {
    const Publisher publisher;
    std::this_thread::sleep_for(milliseconds(2500));
  }
  const std::string lines = output.get();
  EXPECT_THAT(lines, ContainsRegex("measured +authority 1.00 +command +\\+114.592"));
  EXPECT_THAT(lines, ContainsRegex("ramping +authority 0.[0-9]+ +command"));
  EXPECT_THAT(lines, ContainsRegex("safe +authority 0.00 +command +[+-]0.000"));
}

INSTANTIATE_TEST_SUITE_P(Examples, ExampleController,
                         testing::Values(CARTVO_STEERING_SUBSCRIBER, CARTVO_C_CONTROLLER));

}  // namespace
}  // namespace cartvo::client
