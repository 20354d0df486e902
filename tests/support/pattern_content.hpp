#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>

#include <opencv2/core/mat.hpp>
#include <opencv2/core/saturate.hpp>
#include <opencv2/core/types.hpp>

#include "tools/simulate/content.hpp"

namespace cartvo::test {

/// Image size, rate, geometry and motion of a PatternContent.
struct PatternSettings {
  cv::Size size{320, 240};
  double frame_rate = 20.0;  ///< Hz
  int pairs = 20;
  double offset_s = 0.0;        ///< right minus left instant
  double focal_length = 240.0;  ///< px
  double baseline = 0.115;      ///< m
  double depth = 2.0;           ///< of the wall, m
  double speed = 0.4;           ///< of the cameras along the wall, to their right, m/s
};

/// Small test content with exactly known motion: two distortion-free cameras face a wall at a constant depth
/// and move along it to their right (-y of the body) at a constant speed, each with its own exposure
/// instants. The texture of the wall is a smooth sum of waves, evaluated exactly for each pixel.
class PatternContent : public simulate::Content {
 public:
  explicit PatternContent(const PatternSettings& settings) : settings_(settings) {}

  calib::Rig rig() const override {
    calib::Rig rig;
    rig.name = "pattern";
    rig.left.size = settings_.size;
    rig.left.fx = rig.left.fy = settings_.focal_length;
    rig.left.cx = (settings_.size.width - 1) / 2.0;
    rig.left.cy = (settings_.size.height - 1) / 2.0;
    rig.right = rig.left;
    rig.T_right_left.translation().x() = -settings_.baseline;
    rig.T_body_camera = calib::forwardLookingMount();
    return rig;
  }

  double frameRate() const override { return settings_.frame_rate; }
  int pairCount() const override { return settings_.pairs; }
  std::int64_t leftInstant(int index) const override {
    return std::llround(index * 1e9 / settings_.frame_rate);
  }
  std::int64_t rightInstant(int index) const override {
    return leftInstant(index) + std::llround(settings_.offset_s * 1e9);
  }

  void images(int index, cv::Mat& left, cv::Mat& right) const override {
    left = view(cameraX(leftInstant(index)));
    right = view(cameraX(rightInstant(index)) + settings_.baseline);
  }

  Trajectory truth() const override {
    Trajectory truth;
    for (int index = 0; index < settings_.pairs; ++index) {
      StampedPose stamped{.time_ns = leftInstant(index)};
      stamped.pose.translation().y() = -cameraX(stamped.time_ns);
      truth.push_back(stamped);
    }
    return truth;
  }

  std::string cacheKey() const override {
    return "waves " + std::to_string(settings_.size.width) + "x" + std::to_string(settings_.size.height) +
           " " + std::to_string(settings_.frame_rate) + " Hz, " + std::to_string(settings_.pairs) +
           " pairs, offset " + std::to_string(settings_.offset_s) + " s, f " +
           std::to_string(settings_.focal_length) + ", b " + std::to_string(settings_.baseline) + ", Z " +
           std::to_string(settings_.depth) + ", v " + std::to_string(settings_.speed);
  }

 private:
  double cameraX(std::int64_t instant_ns) const {
    return settings_.speed * static_cast<double>(instant_ns) * 1e-9;
  }

  cv::Mat view(double camera_x) const {
    cv::Mat image(settings_.size, CV_8UC1);
    const double metres_per_pixel = settings_.depth / settings_.focal_length;
    for (int row = 0; row < image.rows; ++row) {
      const double y = (row - (image.rows - 1) / 2.0) * metres_per_pixel;
      for (int column = 0; column < image.cols; ++column) {
        const double x = camera_x + (column - (image.cols - 1) / 2.0) * metres_per_pixel;
        image.at<std::uint8_t>(row, column) = cv::saturate_cast<std::uint8_t>(128.0 + 100.0 * wall(x, y));
      }
    }
    return image;
  }

  // Texture of the wall at (x, y) in m, between -1.25 and 1.25: twelve waves of 9 to 31 cm whose directions
  // and lengths are spread by the golden ratio. Moved by 6 cm to 1 m, the texture correlates with itself by
  // at most 0.61.
  static double wall(double x, double y) {
    constexpr int kWaves = 12;
    constexpr double kGoldenRatio = std::numbers::phi;
    static const auto wave_vectors = [] {
      std::array<cv::Point2d, kWaves> vectors;  // rad/m
      for (int i = 0; i < kWaves; ++i) {
        const double turns = i / kGoldenRatio;
        const double length = 20.0 * std::pow(3.6, turns - std::floor(turns));
        const double angle = 2.0 * std::numbers::pi * i / (kGoldenRatio * kGoldenRatio);
        vectors[i] = {length * std::cos(angle), length * std::sin(angle)};
      }
      return vectors;
    }();
    double sum = 0.0;
    for (int i = 0; i < kWaves; ++i)
      sum += std::sin(wave_vectors[i].x * x + wave_vectors[i].y * y + i);
    return 1.5 / kWaves * sum;
  }

  PatternSettings settings_;
};

}  // namespace cartvo::test
