// Camera photometry: automatic exposure, vignetting, sensor noise and tone curve.
#include "lab/render/tracing/photometry.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "lab/render/surface/hash.hpp"
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

}  // namespace cartvo::world
