#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "lab/render/surface/lighting.hpp"
#include "lab/render/surface/material.hpp"
#include "lab/render/tracing/lens.hpp"
#include "lab/render/tracing/scene.hpp"

namespace cartvo::world {

/// Positions of rays within pixels: stratified in each pixel and different from pixel to pixel and frame to
/// frame, so that the remaining sampling error looks like grain and not like a fixed grid.
class SamplePatterns {
 public:
  static constexpr int kMaxPixelSamples = 16;  ///< samples per pixel

  SamplePatterns();

  /// `samples` offsets from the pixel's centre, px, in [-0.5, 0.5). `samples`: 1, 2, 4, 8 or 16.
  const Eigen::Vector2f* offsets(int samples, std::uint32_t pixel_hash) const {
    return &patterns_[level(samples)][static_cast<std::size_t>(pixel_hash % kVariants) * samples];
  }

 private:
  static constexpr int kVariants = 256;
  static std::size_t level(int samples) {
    std::size_t level = 0;
    while ((1 << level) < samples)
      ++level;
    return level;
  }

  std::array<std::vector<Eigen::Vector2f>, 5> patterns_;
};

/// Sampling of an image.
struct RenderSettings {
  /// Additional rays per pixel near an edge; after half of them only where the pixel shows the edge.
  int edge_samples = 4;
  int threads = 2;
};

/// A camera while it takes an image.
struct View {
  const RayTable* rays = nullptr;
  cv::Size size;
  /// Poses in campus axes, at the instant of each row from the upper one on; a single pose holds for all
  /// rows.
  std::vector<Eigen::Isometry3f> T_map_camera;
  std::uint32_t sample_seed = 0;  ///< selects the sample pattern of each pixel

  const Eigen::Isometry3f& poseOf(int row) const {
    return T_map_camera[T_map_camera.size() == 1 ? 0 : static_cast<std::size_t>(row)];
  }

  /// Instant of a row as a fraction of the time from the upper edge of the image to the lower one.
  float timeOf(int row) const {
    return T_map_camera.size() == 1 ? 0.0F
                                    : (static_cast<float>(row) + 0.5F) / static_cast<float>(size.height);
  }
};

/// Radiance of each pixel, CV_32FC1 (unit: see Lighting), by ray casting. Several rays per pixel find the
/// surfaces and shadows; each surface is shaded once per pixel, with its texture filtered in closed form.
cv::Mat renderRadiance(const Scene& scene, const Lighting& lighting, const TextureStyle& style,
                       const RenderSettings& settings, const View& view);

/// Writes the depth at each pixel's centre (CV_32FC1, m; 0: sky) and 255 where it shows a moving object
/// (CV_8UC1).
void renderDepthAndMotion(const Scene& scene, const RenderSettings& settings, const View& view,
                          cv::Mat& depth, cv::Mat& moving);

}  // namespace cartvo::world
