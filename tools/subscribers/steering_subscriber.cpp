// Example of a steering controller: damps the yaw rate that CARTVO_ODOMETRY measures, extrapolated to now.
// Without odometry its correction goes to zero within 0.5 s. Usage: steering_subscriber [LCM-URL]

#include "tools/subscribers/controller_loop.hpp"

int main(int argument_count, char** arguments) {
  constexpr double kGain = 4.0;  // degrees of the steering wheel per deg/s
  constexpr double kDegrees = 57.29577951308232;
  const std::string lcm_url = argument_count > 1 ? arguments[1] : cartvo::client::defaultLcmUrl();
  return cartvo::runController(lcm_url, "deg", [](const cartvo::client::Motion& motion) {
    return -kGain * kDegrees * motion.angular_velocity[2];
  });
}
