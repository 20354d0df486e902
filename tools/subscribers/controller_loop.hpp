#pragma once

#include <chrono>
#include <cstdio>
#include <string>
#include <thread>

#include <cartvo/client.hpp>

// The control loop of the two example controllers. Needs cartvo_client only.

namespace cartvo {

constexpr std::chrono::milliseconds kControlPeriod{25};  // 40 Hz

/// Why there is no usable message, for the operator.
inline std::string faultText(const client::OdometryClient& odometry, const client::ControllerInput& input) {
  if (input.two_publishers) return "two daemons publish";
  if (odometry.newest().kept() > 0)
    return std::string("last message ") + client::verdictText(input.verdict) + ", reasons " +
           std::to_string(odometry.newest().message().reasons);
  return odometry.undecodable() > 0 ? "messages come, but cannot be decoded: cartvod is of another release"
                                    : "no message, cartvod is not running";
}

/// Prints one line: state, authority and `command`, each time the state changes and five times a second.
inline void printInput(const client::OdometryClient& odometry, const client::ControllerInput& input,
                       double command, const char* unit) {
  std::printf("%-8s  authority %4.2f  command %+8.3f %s  speed %6.2f m/s  age %4.0f ms  lost %lld",
              stateText(input.state), input.authority, command, unit, input.motion.velocity[0],
              1e-3 * static_cast<double>(input.age_us), static_cast<long long>(odometry.newest().lost()));
  if (input.state != client::InputState::measured) std::printf("  %s", faultText(odometry, input).c_str());
  std::printf("\n");
}

/// Endless control loop at 40 Hz. `wanted` computes the command from the motion, `double(const
/// client::Motion&)`; without odometry the command goes to zero within 0.5 s. `unit`: the command's, for the
/// printed line. Returns, with the program's exit code, only if LCM cannot be reached.
template <typename Wanted>
int runController(const std::string& lcm_url, const char* unit, Wanted wanted) {
  constexpr int kCyclesPerLine = 8;
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  lcm::LCM lcm(lcm_url);
  if (!lcm.good()) {
    std::fprintf(stderr, "cannot open LCM at %s: check that a multicast route exists, see cartvod(8)\n",
                 lcm_url.c_str());
    return 1;
  }
  client::OdometryClient odometry(lcm);
  auto next = client::SteadyClock::now();
  auto state = client::InputState::waiting;
  for (int cycle = 0;; ++cycle) {
    odometry.update(0);
    const client::ControllerInput input = odometry.input();
    const double command = input.command(wanted(input.motion));  // to be sent to the actuator
    if (input.state != state || cycle % kCyclesPerLine == 0) printInput(odometry, input, command, unit);
    state = input.state;
    next += kControlPeriod;
    std::this_thread::sleep_until(next);
  }
}

}  // namespace cartvo
