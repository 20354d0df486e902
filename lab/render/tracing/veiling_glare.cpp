// Adds the light that a lens scatters from the sun's disc.
#include "lab/render/tracing/veiling_glare.hpp"

#include <opencv2/core/types.hpp>

namespace cartvo::world {

void addVeilingGlare(cv::Mat& radiance, double focal_length) {
  constexpr float kMinGlareRadiance = 20.0F;  // only the sun's disc exceeds it
  double light = 0.0;
  cv::Point2d centre;
  for (int y = 0; y < radiance.rows; ++y) {
    const auto* row = radiance.ptr<float>(y);
    for (int x = 0; x < radiance.cols; ++x) {
      if (!(row[x] > kMinGlareRadiance)) continue;
      light += row[x];
      centre += static_cast<double>(row[x]) * cv::Point2d(x, y);
    }
  }
  if (light == 0.0) return;
  centre = centre / light;
  // Disability glare after Stiles and Holladay: veil = 10 illuminance / angle^2 with the angle in degrees.
  // The law is for eyes; a slightly dusty lens scatters about as much. Constant below half a degree.
  constexpr double kDegreesPerRadian = 57.29578;
  const double degrees = kDegreesPerRadian / focal_length;
  const double strength = 10.0 * light / (focal_length * focal_length);
  for (int y = 0; y < radiance.rows; ++y) {
    auto* row = radiance.ptr<float>(y);
    for (int x = 0; x < radiance.cols; ++x) {
      const double dx = degrees * (x - centre.x);
      const double dy = degrees * (y - centre.y);
      row[x] += static_cast<float>(strength / (dx * dx + dy * dy + 0.25));
    }
  }
}

}  // namespace cartvo::world
