// What a steering controller would start from: speed and yaw rate from CARTVO_ODOMETRY, used only while valid
// and fresh. Usage: steering_subscriber [LCM-URL]

#include <chrono>
#include <cstdio>

#include "tools/subscribers/latest_odometry.hpp"

namespace {

constexpr int kSilence_ms = 500;  // nine frames at 18 fps: the daemon is dead

std::int64_t nowUtime() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

}  // namespace

int main(int argument_count, char** arguments) {
  lcm::LCM lcm(argument_count > 1 ? arguments[1] : "udpm://239.255.76.67:7667?ttl=0");
  if (!lcm.good()) {
    std::fprintf(stderr, "no LCM: is there a multicast route? See cartvod(8)\n");
    return 1;
  }
  cartvo::LatestOdometry odometry(lcm);
  for (;;) {
    if (!odometry.update(kSilence_ms)) {
      std::printf("silence: cartvod is not running; hold the steering angle and slow down\n");
      continue;
    }
    const cartvo::odometry_t& message = odometry.message();
    const std::int64_t now = nowUtime();
    const double age_ms = static_cast<double>(now - message.utime) * 1e-3;
    if (!odometry.isUsable(now)) {
      std::printf("unusable: status %d, reasons %d, age %.1f ms; hold the steering angle and slow down\n",
                  message.status, message.reasons, age_ms);
      continue;
    }
    std::printf("speed %6.2f m/s  yaw rate %+7.4f rad/s  age %5.1f ms  lost %lld\\n",
                message.velocity_body[0], message.angular_velocity_body[2], age_ms,
                static_cast<long long>(odometry.lost()));
  }
}
