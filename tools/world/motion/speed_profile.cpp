// Computes the cart's speed over time from scenario, bends, motor and brakes.
#include "tools/world/motion/speed_profile.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo::world {
namespace {

constexpr double kAcceleration = 1.1;         // m/s^2
constexpr double kBraking = 1.6;              // m/s^2
constexpr double kLateralAcceleration = 2.1;  // m/s^2
constexpr double kYawRate = 0.47;             // rad/s: 27 deg/s
constexpr double kTopSpeed = 6.0;             // m/s
constexpr double kMotorwaySpeed = 20.0;       // m/s, from the start
constexpr double kPathStep = 0.5;             // m along the path, grid of the speed limits

/// Speed limit at each kPathStep of the path, m/s: from lateral acceleration and yaw rate in bends, and lower
/// before them so that braking suffices.
std::vector<double> cornerSpeedLimits(const Path& path) {
  const int count = static_cast<int>(path.length() / kPathStep);
  std::vector<double> limits(count);
  for (int i = 0; i < count; ++i) {
    const double curvature = std::max(std::abs(path.at(kPathStep * i).curvature), 1e-4);
    limits[i] = std::min({kTopSpeed, std::sqrt(kLateralAcceleration / curvature), kYawRate / curvature});
  }
  for (int i = 2 * count - 1; i >= 0; --i) {  // two laps, because the path is closed
    const double ahead = limits[(i + 1) % count];
    limits[i % count] = std::min(limits[i % count], std::sqrt(ahead * ahead + 1.4 * kBraking * kPathStep));
  }
  return limits;
}

/// Speed that the scenario demands at `time` s after the lead-in, m/s.
double wantedSpeed(Scenario scenario, double time) {
  const double cruise = 5.3 + 0.6 * std::sin(0.31 * time) + 0.3 * std::sin(0.83 * time);
  switch (scenario) {
    case Scenario::standing:
      return 0.0;
    case Scenario::traffic:
      return 3.6 + 0.8 * std::sin(0.4 * time);
    case Scenario::garage:
      return 2.6 + 0.3 * std::sin(0.83 * time);
    case Scenario::crowd:
      return 1.6 + 0.4 * std::sin(0.83 * time);
    case Scenario::stop_and_go:
      return std::fmod(time, 11.0) < 6.5 ? cruise : 0.0;
    case Scenario::reversing: {
      const double phase = std::fmod(time, 17.0);
      if (phase < 7.0) return 2.6;
      if (phase < 9.5) return 0.0;
      return phase < 14.5 ? -1.7 : 0.0;
    }
    default:
      return cruise;
  }
}

/// Running mean over the last `count` values; causal, so that a standstill keeps its start.
void smoothCausally(std::vector<double>& values, int count) {
  const std::vector<double> raw = values;
  double sum = raw.front() * count;
  for (int i = 0; i < static_cast<int>(raw.size()); ++i) {
    sum += raw[i] - raw[std::max(i - count, 0)];
    values[i] = sum / count;
    if (std::abs(values[i]) < 1e-9) values[i] = 0.0;
  }
}

}  // namespace

std::vector<double> speedProfile(const Path& path, const WorldSettings& settings) {
  const int steps = static_cast<int>(std::ceil((settings.seconds + 2.0) / kSpeedStep));
  if (settings.scenario == Scenario::motorway) return std::vector<double>(steps, kMotorwaySpeed);
  const std::vector<double> limits = cornerSpeedLimits(path);
  std::vector<double> speeds(steps, 0.0);
  double speed = 0.0;
  double distance = 0.0;
  for (int i = 0; i < steps; ++i) {
    const double time = (i - 3) * kSpeedStep -
                        settings.lead_in_seconds;  // later by the spline's support: at standstill until then
    if (time > 0.0) {
      const auto cell = static_cast<std::ptrdiff_t>(std::floor(distance / kPathStep));
      const auto count = static_cast<std::ptrdiff_t>(limits.size());
      double limit = limits[((cell % count) + count) % count];
      if (settings.scenario == Scenario::loop) {  // one lap
        limit = std::min(limit, std::sqrt(kBraking * std::max(path.length() - distance, 0.0)));
      }
      const double wanted = std::clamp(wantedSpeed(settings.scenario, time), -limit, limit);
      const double slowing = std::abs(wanted) < std::abs(speed) ? kBraking : kAcceleration;
      speed += std::clamp(wanted - speed, -slowing * kSpeedStep, slowing * kSpeedStep);
    }
    distance += speed * kSpeedStep;
    speeds[i] = speed;
  }
  for (int pass = 0; pass < 3; ++pass)
    smoothCausally(speeds, 14);
  return speeds;
}

}  // namespace cartvo::world
