#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include <opencv2/core/mat.hpp>

#include "tools/world/lens.hpp"
#include "tools/world/lighting.hpp"
#include "tools/world/material.hpp"
#include "tools/world/sample_pattern.hpp"
#include "tools/world/scene.hpp"

namespace cartvo::world {

/// How a picture is sampled.
struct RenderSettings {
  int edge_samples =
      4;  ///< further rays where an edge is near; past the first four only where it is in the pixel
  int threads = 2;
};

/// A camera at an instant.
struct View {
  const RayTable* rays = nullptr;
  cv::Size size;
  Eigen::Isometry3f T_map_camera = Eigen::Isometry3f::Identity();
  std::uint32_t sample_seed = 0;  ///< which of the sample patterns each pixel takes
};

/// Light arriving at each pixel, CV_32FC1 (unit: see Lighting), by ray casting: several rays a pixel find the
/// surfaces and the sun's shadows, and each surface is shaded once a pixel with its texture averaged in
/// closed form.
cv::Mat renderRadiance(const Scene& scene, const Lighting& lighting, const TextureStyle& style,
                       const RenderSettings& settings, const View& view);

/// What the ray through each pixel's centre meets: CV_32FC1 depth (0: sky) and CV_8UC1 whether it moves
/// (255).
void renderDepthAndMotion(const Scene& scene, const RenderSettings& settings, const View& view,
                          cv::Mat& depth, cv::Mat& moving);

}  // namespace cartvo::world
