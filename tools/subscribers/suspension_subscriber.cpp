// Example of a suspension controller: vertical velocity, pitch rate and roll rate from CARTVO_ODOMETRY, used
// only while valid and fresh. Usage: suspension_subscriber [LCM-URL]

#include <array>

#include "tools/subscribers/controller_loop.hpp"

namespace {

std::string command(const cartvo::odometry_t& message) {
  std::array<char, 128> line{};
  std::snprintf(line.data(), line.size(),
                "vertical %+6.3f m/s  pitch rate %+7.4f rad/s  roll rate %+7.4f rad/s",
                message.velocity_body[2], message.angular_velocity_body[1], message.angular_velocity_body[0]);
  return line.data();
}

}  // namespace

int main(int argument_count, char** arguments) {
  const std::string lcm_url = argument_count > 1 ? arguments[1] : "udpm://239.255.76.67:7667?ttl=0";
  return cartvo::runController(lcm_url, "go to the passive damper setting", command);
}
