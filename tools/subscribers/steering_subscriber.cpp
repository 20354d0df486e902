// Example of a steering controller: speed and yaw rate from CARTVO_ODOMETRY, used only while valid and fresh.
// Usage: steering_subscriber [LCM-URL]

#include <array>

#include "tools/subscribers/controller_loop.hpp"

namespace {

std::string command(const cartvo::odometry_t& message) {
  std::array<char, 128> line{};
  std::snprintf(line.data(), line.size(), "speed %6.2f m/s  yaw rate %+7.4f rad/s", message.velocity_body[0],
                message.angular_velocity_body[2]);
  return line.data();
}

}  // namespace

int main(int argument_count, char** arguments) {
  const std::string lcm_url = argument_count > 1 ? arguments[1] : "udpm://239.255.76.67:7667?ttl=0";
  return cartvo::runController(lcm_url, "hold the steering angle and slow down", command);
}
