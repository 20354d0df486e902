#pragma once

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace cartvo::test {

/// Pictures of a wall that is lit by a lamp on the mains, by a rolling shutter.
struct MainsLight {
  double mains = 50.0;      ///< Hz; the brightness varies with the square of the voltage
  double readout = 0.032;   ///< s
  double exposure = 0.002;  ///< s
  double depth = 0.5;       ///< share of the light that is proportional to sin^2; the rest is constant
  double noise = 2.0;       ///< grey levels
  cv::Size size{320, 240};
  double lit_rows = 1.0;  ///< part of the picture, from the top, that the lamp lights fully; half below

  /// Picture whose middle row has its mid-exposure at `time`, s.
  cv::Mat image(double time) const {
    constexpr double kPi = 3.14159265358979323846;
    cv::Mat wall(size, CV_32FC1);
    cv::RNG texture(7);
    texture.fill(wall, cv::RNG::UNIFORM, 60.0, 200.0);
    cv::GaussianBlur(wall, wall, {0, 0}, 3.0);
    wall = 110.0 + 2.5 * (wall - 130.0);
    // The mean of sin^2 over the exposure.
    const double x = 2.0 * kPi * mains * exposure;
    const double attenuation = x > 0.0 ? std::sin(x) / x : 1.0;
    for (int row = 0; row < size.height; ++row) {
      const double share = (row + 0.5) / size.height - 0.5;
      const double light = 0.5 - 0.5 * attenuation * std::cos(4.0 * kPi * mains * (time + share * readout));
      const double row_depth = row < lit_rows * size.height ? depth : 0.5 * depth;
      wall.row(row) *= 1.0 + row_depth * (2.0 * light - 1.0);
    }
    cv::Mat errors(size, CV_32FC1), grey;
    cv::RNG random(static_cast<std::uint64_t>(std::llround(1e6 * time)) + 1);
    random.fill(errors, cv::RNG::NORMAL, 0.0, noise);
    cv::Mat(wall + errors).convertTo(grey, CV_8UC1);
    return grey;
  }
};

}  // namespace cartvo::test
