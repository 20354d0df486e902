#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "lab/render/motion/uniform_spline.hpp"
#include "lab/render/world_settings.hpp"

namespace cartvo::world {

/// Automatic exposure control: the exposure factor over time.
class ExposureControl {
 public:
  static constexpr double kMeterStep = 0.5;  ///< s between measurements of the scene

  /// `metered`: mean radiance of the scene at 0, kMeterStep, 2 kMeterStep ...
  ExposureControl(const WorldSettings& settings, const std::vector<double>& metered);

  /// Factor on radiance at `seconds`; a product of 1 is the sensor's full scale.
  double exposure(double seconds) const;

 private:
  UniformSpline log2_exposure_;
  bool jumps_ = false;  ///< scenario `exposure`: steps of three stops
};

/// Properties of one camera's lens and sensor.
struct SensorSettings {
  float gain = 1.0F;            ///< factor on the controlled exposure
  cv::Point2f vignette_centre;  ///< px
  float vignette = 0.3F;        ///< fraction of light lost in the far corner
  float lens_blur = 0.11F;      ///< fraction of a pixel's light that falls on each neighbour, per axis
  float noise = 1.0F;           ///< factor on the noise; 0: none
};

/// Converts radiance (CV_32FC1) to grey levels (CV_8UC1): lens blur, vignetting, exposure, photon and
/// read-out noise, tone curve. `noise_seed` must differ from image to image.
cv::Mat exposeImage(const cv::Mat& radiance, double exposure, const SensorSettings& sensor,
                    std::uint32_t noise_seed, int threads);

/// Replaces parts of `radiance` (CV_32FC1) by what drops of water on the lens show: the scene upside down,
/// smaller and out of focus. The places of the drops in the image depend on `seed` alone.
void addLensDrops(cv::Mat& radiance, std::uint32_t seed);

/// Adds veiling glare to `radiance` (CV_32FC1, unit: see Lighting): light that the lens scatters over the
/// image from a visible sun. `focal_length` in px.
void addVeilingGlare(cv::Mat& radiance, double focal_length);

}  // namespace cartvo::world
