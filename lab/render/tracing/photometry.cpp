// Camera photometry: drops on the lens, glare, automatic exposure, vignetting, sensor noise and tone curve.
#include "lab/render/tracing/photometry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <opencv2/core/types.hpp>
#include <opencv2/imgproc.hpp>

#include "lab/render/surface/hash.hpp"
#include "lab/render/surface/patterns.hpp"
#include "lab/render/tracing/parallel.hpp"

namespace cartvo::world {
namespace {

constexpr double kTargetMean = 0.22;   // fraction of full scale, linear
constexpr double kBaseExposure = 1.5;  // by shutter up to here; beyond it by gain, which adds noise
constexpr double kMaxGain = 12.0;
constexpr double kControlTimeConstant = 1.5;   // s, the control's time constant
constexpr float kFullWellElectrons = 9000.0F;  // electrons at full scale without gain
constexpr float kReadNoise = 0.0013F;          // fraction of full scale without gain

/// Exposure factor of the scenario `exposure`: 1 for four seconds, then alternating by three stops every
/// four.
double jumpFactor(double seconds) {
  constexpr double kFirst = 4.0;
  constexpr double kPeriod = 4.0;
  if (seconds < kFirst) return 1.0;
  const auto phase = static_cast<int>((seconds - kFirst) / kPeriod);
  return phase % 2 == 0 ? std::exp2(-1.8) : std::exp2(1.2);
}

/// A camera's tone curve: gamma with a shoulder that compresses highlights. Tabulated over the square root of
/// the signal.
class ToneCurve {
 public:
  ToneCurve() {
    for (int i = 0; i <= kSize; ++i) {
      const double root = static_cast<double>(kRange) * i / kSize;
      const double x = root * root;
      const double shoulder = x * (1.0 + x / 6.0) / (1.0 + 0.65 * x);
      levels_[static_cast<std::size_t>(i)] =
          static_cast<float>(255.0 * std::min(1.0, std::pow(shoulder, 1.0 / 2.2) * 1.02));
    }
  }
  float level(float signal) const {
    if (!(signal > 0.0F)) return levels_[0];  // also for NaN
    const float position = std::min(std::sqrt(signal) * (static_cast<float>(kSize) / kRange),
                                    static_cast<float>(kSize) - 0.001F);
    const int i = static_cast<int>(position);
    return levels_[i] + (position - static_cast<float>(i)) * (levels_[i + 1] - levels_[i]);
  }

 private:
  static constexpr int kSize = 1024;
  static constexpr float kRange = 2.0F;
  std::array<float, kSize + 1> levels_{};
};

/// About normal with unit variance: the scaled sum of four uniform bytes.
float normalDeviate(std::uint32_t bits) {
  const std::uint32_t sum = (bits & 255U) + (bits >> 8U & 255U) + (bits >> 16U & 255U) + (bits >> 24U);
  return (static_cast<float>(sum) - 510.0F) * (1.0F / 147.8F);
}

}  // namespace

ExposureControl::ExposureControl(const WorldSettings& settings, const std::vector<double>& metered)
    : jumps_(settings.scenario == Scenario::exposure) {
  std::vector<double> log2_exposure;
  double state = 0.0;
  for (std::size_t i = 0; i < metered.size(); ++i) {
    const double wanted =
        std::min(std::log2(kTargetMean / std::max(metered[i], 1e-6)), std::log2(kBaseExposure * kMaxGain));
    state = i == 0 ? wanted : state + (wanted - state) * (1.0 - std::exp(-kMeterStep / kControlTimeConstant));
    log2_exposure.push_back(state);
  }
  if (!log2_exposure.empty()) log2_exposure_ = UniformSpline(kMeterStep, std::move(log2_exposure));
}

double ExposureControl::exposure(double seconds) const {
  return std::exp2(log2_exposure_.value(seconds)) * (jumps_ ? jumpFactor(seconds) : 1.0);
}

cv::Mat exposeImage(const cv::Mat& radiance, double exposure, const SensorSettings& sensor,
                    std::uint32_t noise_seed, int threads) {
  static const ToneCurve tone;
  cv::Mat image(radiance.size(), CV_8UC1);
  const auto scale = static_cast<float>(exposure) * sensor.gain;
  const auto gain = static_cast<float>(std::max(1.0, exposure / kBaseExposure));
  const float shot = sensor.noise * sensor.noise * gain / kFullWellElectrons;
  const float read = sensor.noise * sensor.noise * gain * gain * kReadNoise * kReadNoise;
  const float half_diagonal2 =
      0.25F * static_cast<float>(radiance.cols * radiance.cols + radiance.rows * radiance.rows);
  const float side = sensor.lens_blur;
  const float middle = 1.0F - 2.0F * side;
  parallelFor(radiance.rows, threads, [&](int y) {
    const float* above = radiance.ptr<float>(std::max(y - 1, 0));
    const float* here = radiance.ptr<float>(y);
    const float* below = radiance.ptr<float>(std::min(y + 1, radiance.rows - 1));
    const auto column = [&](int x) { return side * (above[x] + below[x]) + middle * here[x]; };
    auto* out = image.ptr<std::uint8_t>(y);
    const float dy = static_cast<float>(y) - sensor.vignette_centre.y;
    const std::uint32_t row_seed = hashOf({noise_seed, static_cast<std::uint32_t>(y)});
    float left = column(0);
    float centre = left;
    for (int x = 0; x < radiance.cols; ++x) {
      const float right = column(std::min(x + 1, radiance.cols - 1));
      const float dx = static_cast<float>(x) - sensor.vignette_centre.x;
      const float vignette = 1.0F - sensor.vignette * (dx * dx + dy * dy) / half_diagonal2;
      float signal = scale * vignette * (side * (left + right) + middle * centre);
      const std::uint32_t bits = mixBits(row_seed + static_cast<std::uint32_t>(x) * 0x9e3779b9U);
      signal += normalDeviate(bits) * std::sqrt(std::max(signal, 0.0F) * shot + read);
      out[x] = static_cast<std::uint8_t>(std::lrint(tone.level(signal)));
      left = centre;
      centre = right;
    }
  });
  return image;
}

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
