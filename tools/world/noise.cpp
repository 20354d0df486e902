// Four octaves are evaluated at once, one in each lane of a vector register.
#include "tools/world/noise.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo::world {
namespace {

constexpr int kOctaves = 4;
using Floats = float __attribute__((vector_size(4 * kOctaves)));
using Ints = std::int32_t __attribute__((vector_size(4 * kOctaves)));
using Words = std::uint32_t __attribute__((vector_size(4 * kOctaves)));

constexpr float kInverseDeviation = 4.4F;  // of one octave: measured 1 / standard deviation

// Newer processors get their own copies, chosen when the program is loaded; what they call must be inlined to
// become part of the copy.
#if defined(__x86_64__) && !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
#define CARTVO_EACH_PROCESSOR __attribute__((target_clones("default", "arch=haswell")))
#else
#define CARTVO_EACH_PROCESSOR
#endif
#define CARTVO_INLINE [[gnu::always_inline]] inline

CARTVO_INLINE Ints floorToInt(const Floats& x) {
  const Ints truncated = __builtin_convertvector(x, Ints);
  return truncated + (__builtin_convertvector(truncated, Floats) > x);  // true is -1 in each lane
}

/// The corner's gradient times the way to it: both components are taken from the hash.
CARTVO_INLINE Floats cornerTerm(Words h, const Floats& dx, const Floats& dy) {
  h *= 0x2c1b3c6dU;
  h ^= h >> 15U;
  h *= 0x297a2d39U;
  h ^= h >> 16U;
  const Floats gx = __builtin_convertvector(Ints(h) >> 16, Floats);
  const Floats gy = __builtin_convertvector(Ints(h << 16U) >> 16, Floats);
  return (gx * dx + gy * dy) * 0x1p-15F;
}

CARTVO_INLINE Floats fadeCurve(const Floats& t) {
  return t * t * t * (t * (t * 6.0F - 15.0F) + 10.0F);
}

CARTVO_INLINE Floats gradientNoise(const Floats& x, const Floats& y, const Words& seed) {
  const Ints ix = floorToInt(x);
  const Ints iy = floorToInt(y);
  const Floats dx = x - __builtin_convertvector(ix, Floats);
  const Floats dy = y - __builtin_convertvector(iy, Floats);
  const Words hx = Words(ix) * 0x9e3779b1U + seed;
  const Words hy = Words(iy) * 0x85ebca77U;
  const Words hx1 = hx + 0x9e3779b1U;
  const Words hy1 = hy + 0x85ebca77U;
  const Floats n00 = cornerTerm(hx ^ hy, dx, dy);
  const Floats n10 = cornerTerm(hx1 ^ hy, dx - 1.0F, dy);
  const Floats n01 = cornerTerm(hx ^ hy1, dx, dy - 1.0F);
  const Floats n11 = cornerTerm(hx1 ^ hy1, dx - 1.0F, dy - 1.0F);
  const Floats u = fadeCurve(dx);
  const Floats v = fadeCurve(dy);
  const Floats bottom = n00 + u * (n10 - n00);
  const Floats top = n01 + u * (n11 - n01);
  return bottom + v * (top - bottom);
}

CARTVO_INLINE float sumOf(const Floats& x) {
  return (x[0] + x[1]) + (x[2] + x[3]);
}

// Each octave's lattice is turned by another angle, so that their axes do not add up to a grid.
constexpr Floats kCosine{1.0F, 0.80F, 0.28F, -0.352F};
constexpr Floats kSine{0.0F, 0.60F, 0.96F, 0.936F};
constexpr Floats kDoubling{1.0F, 2.0F, 4.0F, 8.0F};
constexpr Words kSeeds{0x68bc21ebU, 0xd17843d6U, 0x3a3465c1U, 0xa2f087acU};

}  // namespace

CARTVO_EACH_PROCESSOR float noise(float x, float y, float footprint, const NoiseBand& band,
                                  std::uint32_t seed) {
  // An octave is full below 0.3 cycles a pixel and gone at 0.75.
  constexpr float kGone = 0.75F;
  constexpr float kFadeSlope = 1.0F / (kGone - 0.3F);
  const float last = 1.01F / band.shortest;
  const float g = band.gain;
  const float g2 = g * g;
  const Floats gains{1.0F, g, g2, g2 * g};
  const Floats none{};
  const Floats whole = none + 1.0F;
  float frequency = 1.0F / band.longest;
  float amplitude = 1.0F;
  float sum = 0.0F;
  float variance = 0.0F;
  while (frequency <= last) {
    const Floats f = frequency * kDoubling;
    const Floats a = f <= last ? amplitude * gains : none;
    variance += sumOf(a * a);
    if (frequency * footprint < kGone) {
      const Floats value =
          gradientNoise((kCosine * x - kSine * y) * f, (kSine * x + kCosine * y) * f, kSeeds + seed);
      Floats kept = (kGone - f * footprint) * kFadeSlope;
      kept = kept < none ? none : kept;
      kept = kept > whole ? whole : kept;
      sum += sumOf(value * a * kept);
    }
    frequency *= 16.0F;
    amplitude *= g2 * g2;
    seed += 0x632be5abU;
  }
  return sum * kInverseDeviation / std::sqrt(variance);
}

CARTVO_EACH_PROCESSOR std::array<float, 4> plainNoises(float x, float y,
                                                       const std::array<float, 4>& wavelengths,
                                                       std::uint32_t seed) {
  const Floats f = 1.0F / Floats{wavelengths[0], wavelengths[1], wavelengths[2], wavelengths[3]};
  const Floats value =
      2.0F * gradientNoise((kCosine * x - kSine * y) * f, (kSine * x + kCosine * y) * f, kSeeds + seed);
  return {value[0], value[1], value[2], value[3]};
}

}  // namespace cartvo::world
