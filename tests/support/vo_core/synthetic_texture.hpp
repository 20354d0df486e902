#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <random>

#include <opencv2/core.hpp>

namespace cartvo::test {

/// Two numbers at once: sines of waves take most of the time of tests that draw images.
using Lanes = double __attribute__((vector_size(16)));

/// sin(2 pi turns): Taylor's series within a quarter of a turn, error below 1e-11.
inline Lanes sineOfTurns(Lanes turns) {
  constexpr double kRounder = 0x1.8p52;  // larger numbers have no fractions
  turns -= (turns + kRounder) - kRounder;
  turns = turns > 0.25 ? 0.5 - turns : turns < -0.25 ? -0.5 - turns : turns;
  const Lanes x = 2.0 * M_PI * turns, x2 = x * x;
  Lanes series = 1.0 - x2 / 210.0;
  for (const double factors : {156.0, 110.0, 72.0, 42.0, 20.0, 6.0})
    series = 1.0 - x2 * series / factors;
  return x * series;
}

/// Band-limited texture defined at every real coordinate: a sum of waves of random directions and phases, no
/// shorter than 6 px. Images drawn from it are exact under any shift or warp.
class WaveTexture {
 public:
  explicit WaveTexture(std::uint64_t seed) {
    std::mt19937_64 engine(seed);
    const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1.0p-53; };
    for (std::size_t i = 0; i < 2 * waves_.size(); ++i) {
      WavePair& waves = waves_[i / 2];
      const double length = 6.0 + 30.0 * uniform() * uniform();
      const double angle = 2.0 * M_PI * uniform();
      waves.x[i % 2] = std::cos(angle) / length;
      waves.y[i % 2] = std::sin(angle) / length;
      waves.phase[i % 2] = uniform();
    }
  }

  /// Grey values around 128, within about 60.
  double operator()(double x, double y) const {
    Lanes sum{};
    for (const WavePair& waves : waves_)
      sum += sineOfTurns(waves.x * x + waves.y * y + waves.phase);
    return 128.0 + 8.0 * (sum[0] + sum[1]);
  }

 private:
  struct WavePair {
    Lanes x, y, phase;  ///< turns a pixel along x and y; turns
  };
  std::array<WavePair, 12> waves_{};
};

/// Texture with structure of all sizes, as images of the world have: a WaveTexture at three scales.
class MultiscaleTexture {
 public:
  explicit MultiscaleTexture(std::uint64_t seed) : texture_(seed) {}

  double operator()(double x, double y) const {
    return (texture_(x, y) + texture_(x / 4.0, y / 4.0) + texture_(x / 16.0, y / 16.0)) / 3.0;
  }

 private:
  WaveTexture texture_;
};

/// A CV_8UC1 image whose pixel (x, y) is value(x, y), rounded.
template <typename Value>
cv::Mat draw(int width, int height, const Value& value) {
  cv::Mat image(height, width, CV_8UC1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image.at<unsigned char>(y, x) = cv::saturate_cast<unsigned char>(value(x, y));
  return image;
}

/// Mean and standard deviation of the added values.
class Statistics {
 public:
  void add(double value) {
    ++count_;
    sum_ += value;
    square_ += value * value;
  }
  int count() const { return count_; }
  double mean() const { return sum_ / count_; }
  double stddev() const { return std::sqrt(std::max(square_ / count_ - mean() * mean(), 0.0)); }

 private:
  int count_ = 0;
  double sum_ = 0.0, square_ = 0.0;
};

/// Uniform and normally distributed random numbers, the same on each platform.
class Noise {
 public:
  explicit Noise(std::uint64_t seed) : engine_(seed) {}
  double uniform() { return (static_cast<double>(engine_() >> 11) + 0.5) * 0x1.0p-53; }
  double gaussian() { return std::sqrt(-2.0 * std::log(uniform())) * std::cos(2.0 * M_PI * uniform()); }

 private:
  std::mt19937_64 engine_;
};

}  // namespace cartvo::test
