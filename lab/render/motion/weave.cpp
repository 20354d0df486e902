// Weaves about the path within the lane.
#include "lab/render/motion/weave.hpp"

#include <cmath>
#include <numbers>

#include "lab/render/surface/hash.hpp"

namespace cartvo::world {

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

}  // namespace cartvo::world
