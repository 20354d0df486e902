#include "tools/world/lens_scatter.hpp"

#include <opencv2/core/types.hpp>

namespace cartvo::world {

void scatterInLens(cv::Mat& radiance, double focal_length) {
  constexpr float kBlinding = 20.0F;
  double light = 0.0;
  cv::Point2d centre;
  for (int y = 0; y < radiance.rows; ++y) {
    const auto* row = radiance.ptr<float>(y);
    for (int x = 0; x < radiance.cols; ++x) {
      if (!(row[x] > kBlinding)) continue;
      light += row[x];
      centre += static_cast<double>(row[x]) * cv::Point2d(x, y);
    }
  }
  if (light == 0.0) return;
  centre = centre / light;
  // Stiles and Holladay's law of disability glare: veil = 10 illuminance / angle^2, in degrees; a lens with a
  // little dust on it is about as bad as an eye. It is let off below half a degree.
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
