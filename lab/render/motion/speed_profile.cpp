// Computes the cart's weave, and its speed over time from scenario, bends, motor and brakes.
#include "lab/render/motion/speed_profile.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lab/render/surface/hash.hpp"

namespace cartvo::world {
namespace {

constexpr double kTopSpeed = 6.0;        // m/s
constexpr double kMotorwaySpeed = 20.0;  // m/s, from the start
constexpr double kPathStep = 0.5;        // m along the path, grid of the speed limits

/// Accelerations and rates that the driver demands of the cart.
struct Demands {
  double acceleration = 1.1;          ///< m/s^2
  double braking = 1.6;               ///< m/s^2
  double lateral_acceleration = 2.1;  ///< m/s^2
  double yaw_rate = 0.47;             ///< rad/s: 27 deg/s
  double smoothing = 0.28;            ///< s, length of each of three running means over the speed
};

Demands demandsOf(double liveliness) {
  constexpr Demands kLively{2.4, 3.0, 2.4, 1.0, 0.2};
  constexpr Demands kCalm;
  const auto between = [liveliness](double calm, double lively) {
    return calm + liveliness * (lively - calm);
  };
  return {between(kCalm.acceleration, kLively.acceleration), between(kCalm.braking, kLively.braking),
          between(kCalm.lateral_acceleration, kLively.lateral_acceleration),
          between(kCalm.yaw_rate, kLively.yaw_rate), between(kCalm.smoothing, kLively.smoothing)};
}

/// Speed limit at each kPathStep of the path, m/s: from lateral acceleration and yaw rate in bends, and lower
/// before them so that braking suffices.
std::vector<double> cornerSpeedLimits(const Path& path, const Weave& weave, const Demands& demands) {
  const int count = static_cast<int>(path.length() / kPathStep);
  std::vector<double> limits(count);
  for (int i = 0; i < count; ++i) {
    const double along = kPathStep * i;
    const double curvature = std::max(std::abs(path.at(along).curvature + weave.curvature(along)), 1e-4);
    limits[i] = std::min(
        {kTopSpeed, std::sqrt(demands.lateral_acceleration / curvature), demands.yaw_rate / curvature});
  }
  for (int i = 2 * count - 1; i >= 0; --i) {  // two laps, because the path is closed
    const double ahead = limits[(i + 1) % count];
    limits[i % count] =
        std::min(limits[i % count], std::sqrt(ahead * ahead + 1.4 * demands.braking * kPathStep));
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

/// The same with the briskness of a lively drive: slower, with faster changes.
double wantedSpeed(const WorldSettings& settings, double time) {
  constexpr double kLivelySpeed = 3.4;  // m/s
  const double calm = wantedSpeed(settings.scenario, time * (1.0 + 0.6 * settings.liveliness));
  const double lively = std::clamp(calm, -kLivelySpeed, kLivelySpeed) *
                        (1.0 + 0.26 * std::sin(1.9 * time) + 0.08 * std::sin(4.3 * time));
  return calm + settings.liveliness * (lively - calm);
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

Weave::Weave(const Path& path, const WorldSettings& settings) {
  // The curvatures add to 0.29 / m: 50 deg/s at 3 m/s on a straight path. Heading: up to 17 deg.
  constexpr std::array<double, 2> kAmplitudes = {0.65 * kMaximum, 0.35 * kMaximum};  // m
  constexpr std::array<double, 2> kWavelengths = {8.5, 6.4};                         // m
  Random random(hashOf(
      {static_cast<std::uint32_t>(settings.seed), static_cast<std::uint32_t>(settings.scenario), 511U}));
  for (std::size_t i = 0; i < sines_.size(); ++i) {
    const double waves = std::max(1.0, std::round(path.length() / kWavelengths[i]));  // in one lap
    sines_[i] = {settings.liveliness * kAmplitudes[i], 2.0 * std::numbers::pi * waves / path.length(),
                 random.uniform(0.0, 2.0 * std::numbers::pi)};
  }
}

double Weave::lateral(double distance) const {
  double sum = 0.0;
  for (const Sine& sine : sines_)
    sum += sine.amplitude * std::sin(sine.wave_number * distance + sine.phase);
  return sum;
}

double Weave::slope(double distance) const {
  double sum = 0.0;
  for (const Sine& sine : sines_)
    sum += sine.amplitude * sine.wave_number * std::cos(sine.wave_number * distance + sine.phase);
  return sum;
}

double Weave::curvature(double distance) const {
  double sum = 0.0;
  for (const Sine& sine : sines_) {
    sum -= sine.amplitude * sine.wave_number * sine.wave_number *
           std::sin(sine.wave_number * distance + sine.phase);
  }
  return sum;
}

int speedSteps(const WorldSettings& settings) {
  return static_cast<int>(std::ceil((startOf(settings) + settings.seconds + 2.0) / kSpeedStep));
}

std::vector<double> speedProfile(const Path& path, const Weave& weave, const WorldSettings& settings) {
  const int steps = speedSteps(settings);
  if (settings.scenario == Scenario::motorway) return std::vector<double>(steps, kMotorwaySpeed);
  const Demands demands = demandsOf(settings.liveliness);
  const std::vector<double> limits = cornerSpeedLimits(path, weave, demands);
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
        limit = std::min(limit, std::sqrt(demands.braking * std::max(path.length() - distance, 0.0)));
      }
      const double wanted = std::clamp(wantedSpeed(settings, time), -limit, limit);
      const double slowing = std::abs(wanted) < std::abs(speed) ? demands.braking : demands.acceleration;
      speed += std::clamp(wanted - speed, -slowing * kSpeedStep, slowing * kSpeedStep);
    }
    distance += speed * kSpeedStep;
    speeds[i] = speed;
  }
  for (int pass = 0; pass < 3; ++pass)
    smoothCausally(speeds, static_cast<int>(std::lround(demands.smoothing / kSpeedStep)));
  return speeds;
}

}  // namespace cartvo::world
