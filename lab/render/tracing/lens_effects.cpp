// Drops that stay where they are on the lens, and the light that it scatters from the sun's disc.
#include "lab/render/tracing/lens_effects.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/core/types.hpp>
#include <opencv2/imgproc.hpp>

#include "lab/render/surface/hash.hpp"
#include "lab/render/surface/patterns.hpp"

namespace cartvo::world {
namespace {

constexpr int kDrops = 34;
constexpr double kMinRadius = 0.009;  // of the image's width
constexpr double kMaxRadius = 0.045;
constexpr double kBlur = 0.012;        // of the image's width: the lens focuses on the scene
constexpr float kSoftEdge = 0.55F;     // share of the radius at which a drop begins to fade
constexpr float kMinification = 2.5F;  // of the scene that a drop shows upside down
constexpr float kTransmission = 0.85F;

struct Drop {
  float x, y;    ///< px
  float radius;  ///< px, along x
  float aspect;  ///< height over width
};

std::vector<Drop> dropsOf(const cv::Size& size, std::uint32_t seed) {
  Random random(hashOf({seed, 801U}));
  std::vector<Drop> drops;
  for (int i = 0; i < kDrops; ++i) {
    Drop& drop = drops.emplace_back();
    drop.x = random.real(0.0, size.width);
    drop.y = random.real(0.0, size.height);
    drop.radius = static_cast<float>(random.uniform(kMinRadius, kMaxRadius) * size.width);
    drop.aspect = random.real(1.0, 1.4);
  }
  return drops;
}

void addDrop(cv::Mat& radiance, const cv::Mat& blurred, const Drop& drop) {
  const auto column = [&](float x) { return std::clamp(static_cast<int>(x), 0, radiance.cols - 1); };
  const auto row = [&](float y) { return std::clamp(static_cast<int>(y), 0, radiance.rows - 1); };
  const float height = drop.radius * drop.aspect;
  for (int y = row(drop.y - height); y <= row(drop.y + height); ++y) {
    for (int x = column(drop.x - drop.radius); x <= column(drop.x + drop.radius); ++x) {
      const float dx = static_cast<float>(x) - drop.x;
      const float dy = static_cast<float>(y) - drop.y;
      const float cover = smoothStep(1.0F, kSoftEdge, std::hypot(dx / drop.radius, dy / height));
      if (cover <= 0.0F) continue;
      const float shown =
          blurred.at<float>(row(drop.y - kMinification * dy), column(drop.x - kMinification * dx));
      float& value = radiance.at<float>(y, x);
      value += cover * (kTransmission * shown - value);
    }
  }
}

}  // namespace

void addLensDrops(cv::Mat& radiance, std::uint32_t seed) {
  cv::Mat blurred;
  cv::GaussianBlur(radiance, blurred, cv::Size(), kBlur * radiance.cols);
  for (const Drop& drop : dropsOf(radiance.size(), seed))
    addDrop(radiance, blurred, drop);
}

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
