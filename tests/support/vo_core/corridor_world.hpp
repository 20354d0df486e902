#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "support/vo_core/synthetic_texture.hpp"
#include "vo_core/stereo_odometry.hpp"

namespace cartvo::test {

/// Renders a textured corridor (walls left and right, floor, end wall) with exact rays. Texture waves shorter
/// than a few pixels at their distance are left out to avoid aliasing.
class CorridorWorld {
 public:
  explicit CorridorWorld(std::uint64_t seed) {
    Noise noise(seed);
    for (auto& plane : waves_) {
      std::array<Wave, 2 * kWavePairs> waves{};
      for (Wave& wave : waves) {
        const double angle = 2.0 * M_PI * noise.uniform();
        const double length = 0.03 * std::pow(100.0, noise.uniform());
        wave = {length, std::cos(angle) / length, std::sin(angle) / length, noise.uniform()};
      }
      std::sort(waves.begin(), waves.end(), [](const Wave& a, const Wave& b) { return a.length > b.length; });
      for (std::size_t i = 0; i < kWavePairs; ++i) {
        const Wave &a = waves[2 * i], &b = waves[2 * i + 1];
        plane[i] =
            WavePair{Lanes{a.length, b.length}, Lanes{a.x, b.x}, Lanes{a.y, b.y}, Lanes{a.phase, b.phase}};
      }
    }
  }

  vo::StereoImages render(const vo::StereoCamera& camera, const Eigen::Isometry3d& T_world_camera,
                          std::int64_t time_ns) const {
    return {view(camera, T_world_camera), rightView(camera, T_world_camera), time_ns, time_ns};
  }

  /// Image of a camera with this pose; image of the right camera of a rig whose left camera has this pose.
  cv::Mat view(const vo::StereoCamera& camera, const Eigen::Isometry3d& T) const {
    return draw(camera.width, camera.height, [&](int x, int y) {
      const Eigen::Vector3d ray = T.linear() * Eigen::Vector3d((x - camera.cx) / camera.focal_length,
                                                               (y - camera.cy) / camera.focal_length, 1.0);
      return shade(T.translation(), ray, camera.focal_length);
    });
  }
  /// Image of a camera with a rolling shutter: `pose_of_row(row)` is its pose while it exposes a row.
  template <typename PoseOfRow>
  cv::Mat rollingView(const vo::StereoCamera& camera, const PoseOfRow& pose_of_row) const {
    cv::Mat image(camera.height, camera.width, CV_8UC1);
    for (int row = 0; row < camera.height; ++row) {
      vo::StereoCamera one_row = camera;
      one_row.cy = camera.cy - row;
      one_row.height = 1;
      view(one_row, pose_of_row(row)).copyTo(image.row(row));
    }
    return image;
  }
  cv::Mat rightView(const vo::StereoCamera& camera, const Eigen::Isometry3d& T_world_camera) const {
    return view(camera, T_world_camera * Eigen::Translation3d(camera.baseline, 0, 0));
  }

 private:
  struct Wave {
    double length, x, y, phase;  ///< m; turns a metre along u and v; turns
  };
  struct WavePair {
    Lanes length, x, y, phase;
  };
  static constexpr int kPlanes = 4;
  static constexpr std::size_t kWavePairs = 14;

  double shade(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray, double focal_length) const {
    // Normal axis and offset (m) of each plane: left and right wall, floor, end wall.
    static constexpr std::array<int, kPlanes> kAxis{0, 0, 1, 2};
    static constexpr std::array<double, kPlanes> kOffset{-2.5, 3.0, 1.3, 30.0};
    int hit = 3;
    double nearest = 1e9;
    for (int plane = 0; plane < kPlanes; ++plane) {
      const double distance = (kOffset[plane] - origin[kAxis[plane]]) / ray[kAxis[plane]];
      if (distance > 0.0 && distance < nearest) {
        nearest = distance;
        hit = plane;
      }
    }
    const Eigen::Vector3d point = origin + nearest * ray;
    const double pixel =
        nearest * ray.norm() * ray.norm() / (focal_length * std::abs(ray[kAxis[hit]]));  // m, along the slope
    const double u = point[(kAxis[hit] + 1) % 3];
    const double v = point[(kAxis[hit] + 2) % 3];
    Lanes sum{};
    for (const WavePair& waves : waves_[hit]) {
      if (waves.length[0] <= 4.0 * pixel) break;
      Lanes visibility = (waves.length / pixel - 4.0) / 4.0;
      visibility = visibility > 1.0 ? Lanes{1.0, 1.0} : visibility < 0.0 ? Lanes{} : visibility;
      sum += visibility * sineOfTurns(waves.x * u + waves.y * v + waves.phase);
    }
    return 128.0 + 12.0 * (sum[0] + sum[1]);
  }

  std::array<std::array<WavePair, kWavePairs>, kPlanes> waves_{};  ///< of each plane, longest first
};

}  // namespace cartvo::test
