#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

namespace cartvo::world {

/// Replaces parts of `radiance` (CV_32FC1) by what drops of water on the lens show: the scene upside down,
/// smaller and out of focus. The places of the drops in the image depend on `seed` alone.
void addLensDrops(cv::Mat& radiance, std::uint32_t seed);

/// Adds veiling glare to `radiance` (CV_32FC1, unit: see Lighting): light that the lens scatters over the
/// image from a visible sun. `focal_length` in px.
void addVeilingGlare(cv::Mat& radiance, double focal_length);

}  // namespace cartvo::world
