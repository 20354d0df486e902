// Example of a suspension controller: a force against the vertical velocity of the body (a skyhook damper).
// Without odometry the force goes to zero within 0.5 s, which leaves the passive damper.
// Usage: suspension_subscriber [LCM-URL]

#include "tools/subscribers/controller_loop.hpp"

int main(int argument_count, char** arguments) {
  constexpr double kDamping = 1500.0;  // N s/m
  const std::string lcm_url = argument_count > 1 ? arguments[1] : cartvo::client::defaultLcmUrl();
  return cartvo::runController(
      lcm_url, "N", [](const cartvo::client::Motion& motion) { return -kDamping * motion.velocity[2]; });
}
