// Blurs the image within drops that stay where they are on the lens.
#include "lab/render/tracing/lens_drops.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

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

}  // namespace cartvo::world
