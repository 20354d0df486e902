#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include <opencv2/core/mat.hpp>

#include "tools/world/render/lens.hpp"
#include "tools/world/render/sample_pattern.hpp"
#include "tools/world/render/scene.hpp"
#include "tools/world/surface/lighting.hpp"
#include "tools/world/surface/material.hpp"

namespace cartvo::world {

/// Sampling of an image.
struct RenderSettings {
  /// Additional rays per pixel near an edge; after half of them only where the pixel shows the edge.
  int edge_samples = 4;
  int threads = 2;
};

/// A camera at one instant.
struct View {
  const RayTable* rays = nullptr;
  cv::Size size;
  Eigen::Isometry3f T_map_camera = Eigen::Isometry3f::Identity();
  std::uint32_t sample_seed = 0;  ///< selects the sample pattern of each pixel
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
