#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "tools/world/uniform_spline.hpp"
#include "tools/world/world_settings.hpp"

namespace cartvo::world {

/// An automatic exposure: what the camera multiplies light with, over time.
class ExposureControl {
 public:
  static constexpr double kMeterStep = 0.5;  ///< s

  /// `metered`: mean radiance of the scene each kMeterStep from time 0.
  ExposureControl(const WorldSettings& settings, const std::vector<double>& metered);

  /// Full scale of the sensor is 1 over this.
  double exposure(double seconds) const;

 private:
  UniformSpline log2_exposure_;
  bool jumps_ = false;  ///< the scenario's steps of three stops
};

/// What is particular to one camera of the two.
struct SensorSettings {
  float gain = 1.0F;            ///< relative to the exposure control's wish
  cv::Point2f vignette_centre;  ///< px
  float vignette = 0.3F;        ///< share of light lost in the far corner
  float lens_blur = 0.11F;      ///< share of a pixel's light that falls to each neighbour in a row
  float noise = 1.0F;           ///< factor; 0: none
};

/// From light to grey levels: the lens' blur and vignetting, the exposure, photon and read-out noise, the
/// tone curve of a camera. `noise_seed` must differ from image to image. `radiance` is CV_32FC1; the result
/// CV_8UC1.
cv::Mat exposeImage(const cv::Mat& radiance, double exposure, const SensorSettings& sensor,
                    std::uint32_t noise_seed, int threads);

}  // namespace cartvo::world
