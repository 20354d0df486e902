// Four octaves are evaluated at once, one in each lane of a vector register.
#include "tools/world/noise.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo::world {
namespace {

using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));
using Uint4 = std::uint32_t __attribute__((vector_size(16)));

constexpr float kInverseDeviation = 4.4F;  // of one octave: measured 1 / standard deviation

// Newer processors get their own copies, chosen when the program is loaded.
#if defined(__x86_64__) && !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
#define CARTVO_EACH_PROCESSOR __attribute__((target_clones("default", "arch=haswell"), flatten))
#else
#define CARTVO_EACH_PROCESSOR
#endif

Float4 splat(float value) {
  return Float4{value, value, value, value};
}

Int4 floorToInt(Float4 x) {
  const Int4 truncated = __builtin_convertvector(x, Int4);
  return truncated + (__builtin_convertvector(truncated, Float4) > x);  // true is -1 in each lane
}

Uint4 mixLanes(Uint4 h) {
  h *= 0x2c1b3c6dU;
  h ^= h >> 15U;
  h *= 0x297a2d39U;
  return h ^ (h >> 16U);
}

/// The corner's gradient times the way to it: both components are taken from the hash.
Float4 cornerTerm(Uint4 h, Float4 dx, Float4 dy) {
  h = mixLanes(h);
  const Float4 gx = __builtin_convertvector(Int4(h) >> 16, Float4);
  const Float4 gy = __builtin_convertvector(Int4(h << 16U) >> 16, Float4);
  return (gx * dx + gy * dy) * splat(0x1p-15F);
}

Float4 fadeCurve(Float4 t) {
  return t * t * t * (t * (t * splat(6.0F) - splat(15.0F)) + splat(10.0F));
}

Float4 gradientNoise(Float4 x, Float4 y, Uint4 seed) {
  const Int4 ix = floorToInt(x);
  const Int4 iy = floorToInt(y);
  const Float4 dx = x - __builtin_convertvector(ix, Float4);
  const Float4 dy = y - __builtin_convertvector(iy, Float4);
  const Uint4 hx = Uint4(ix) * 0x9e3779b1U + seed;
  const Uint4 hy = Uint4(iy) * 0x85ebca77U;
  const Uint4 hx1 = hx + 0x9e3779b1U;
  const Uint4 hy1 = hy + 0x85ebca77U;
  const Float4 one = splat(1.0F);
  const Float4 n00 = cornerTerm(hx ^ hy, dx, dy);
  const Float4 n10 = cornerTerm(hx1 ^ hy, dx - one, dy);
  const Float4 n01 = cornerTerm(hx ^ hy1, dx, dy - one);
  const Float4 n11 = cornerTerm(hx1 ^ hy1, dx - one, dy - one);
  const Float4 u = fadeCurve(dx);
  const Float4 v = fadeCurve(dy);
  const Float4 bottom = n00 + u * (n10 - n00);
  const Float4 top = n01 + u * (n11 - n01);
  return bottom + v * (top - bottom);
}

// Each octave's lattice is turned by another angle, so that their axes do not add up to a grid.
constexpr Float4 kCosine{1.0F, 0.80F, 0.28F, -0.352F};
constexpr Float4 kSine{0.0F, 0.60F, 0.96F, 0.936F};

}  // namespace

CARTVO_EACH_PROCESSOR float noise(float x, float y, float footprint, const NoiseBand& band,
                                  std::uint32_t seed) {
  // An octave is full below 0.3 cycles a pixel and gone at 0.75.
  constexpr float kGone = 0.75F;
  constexpr float kFadeSlope = 1.0F / (kGone - 0.3F);
  float frequency = 1.0F / band.longest;
  const float last = 1.01F / band.shortest;
  float amplitude = 1.0F;
  float sum = 0.0F;
  float variance = 0.0F;
  const float gain2 = band.gain * band.gain;
  while (frequency <= last) {
    const Float4 f = frequency * Float4{1.0F, 2.0F, 4.0F, 8.0F};
    const Float4 a = amplitude * Float4{1.0F, band.gain, gain2, gain2 * band.gain};
    if (frequency * footprint < kGone) {
      const Uint4 s = Uint4{1U, 2U, 3U, 4U} * 0x68bc21ebU + seed;
      const Float4 value = gradientNoise((kCosine * x - kSine * y) * f, (kSine * x + kCosine * y) * f, s);
      for (int lane = 0; lane < 4; ++lane) {
        if (f[lane] > last) break;
        sum += value[lane] * a[lane] * std::clamp((kGone - f[lane] * footprint) * kFadeSlope, 0.0F, 1.0F);
      }
    }
    for (int lane = 0; lane < 4; ++lane) {
      if (f[lane] <= last) variance += a[lane] * a[lane];
    }
    frequency *= 16.0F;
    amplitude *= gain2 * gain2;
    seed += 0x632be5abU;
  }
  return sum * kInverseDeviation / std::sqrt(variance);
}

CARTVO_EACH_PROCESSOR std::array<float, 4> plainNoises(float x, float y,
                                                       const std::array<float, 4>& wavelengths,
                                                       std::uint32_t seed) {
  const Float4 f = splat(1.0F) / Float4{wavelengths[0], wavelengths[1], wavelengths[2], wavelengths[3]};
  const Uint4 s = Uint4{1U, 2U, 3U, 4U} * 0x68bc21ebU + seed;
  const Float4 value = gradientNoise((kCosine * x - kSine * y) * f, (kSine * x + kCosine * y) * f, s) * 2.0F;
  return {value[0], value[1], value[2], value[3]};
}

}  // namespace cartvo::world
