// Gradient noise, evaluated for eight octaves at once, one in each lane of a vector register.
#include "lab/render/surface/noise.hpp"

#include <algorithm>

namespace cartvo::world {
namespace {

/// Vectors of four and of eight lanes.
struct Four {
  using Floats = float __attribute__((vector_size(16)));
  using Ints = std::int32_t __attribute__((vector_size(16)));
  using Words = std::uint32_t __attribute__((vector_size(16)));
};
struct Eight {
  using Floats = float __attribute__((vector_size(32)));
  using Ints = std::int32_t __attribute__((vector_size(32)));
  using Words = std::uint32_t __attribute__((vector_size(32)));
};

constexpr float kInverseStddev = 4.4F;  // 1 / standard deviation of one octave, measured

// Compiles a function also for newer processors; the loader selects the copy. Callees must be inlined to be
// compiled for the same target.
#if defined(__x86_64__) && !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
#define CARTVO_TARGET_CLONES __attribute__((target_clones("default", "arch=x86-64-v3")))
#else
#define CARTVO_TARGET_CLONES
#endif
#define CARTVO_INLINE [[gnu::always_inline]] inline

/// Dot product of a lattice corner's gradient and the vector to it; the hash `h` gives both gradient
/// components.
template <typename Lanes>
CARTVO_INLINE auto cornerTerm(typename Lanes::Words h, const typename Lanes::Floats& dx,
                              const typename Lanes::Floats& dy) {
  using Floats = typename Lanes::Floats;
  using Ints = typename Lanes::Ints;
  h *= 0x2c1b3c6dU;
  h ^= h >> 15U;
  h *= 0x297a2d39U;
  h ^= h >> 16U;
  const Floats gx = __builtin_convertvector(Ints(h) >> 16, Floats);
  const Floats gy = __builtin_convertvector(Ints(h << 16U) >> 16, Floats);
  return (gx * dx + gy * dy) * 0x1p-15F;
}

template <typename Floats>
CARTVO_INLINE Floats fadeCurve(const Floats& t) {
  return t * t * t * (t * (t * 6.0F - 15.0F) + 10.0F);
}

template <typename Lanes>
CARTVO_INLINE auto gradientNoise(const typename Lanes::Floats& x, const typename Lanes::Floats& y,
                                 const typename Lanes::Words& seed) {
  using Floats = typename Lanes::Floats;
  using Ints = typename Lanes::Ints;
  using Words = typename Lanes::Words;
  const auto floor_to_int = [](const Floats& value) __attribute__((always_inline)) {
    const Ints truncated = __builtin_convertvector(value, Ints);
    return truncated + (__builtin_convertvector(truncated, Floats) > value);  // true is -1 in each lane
  };
  const Ints ix = floor_to_int(x);
  const Ints iy = floor_to_int(y);
  const Floats dx = x - __builtin_convertvector(ix, Floats);
  const Floats dy = y - __builtin_convertvector(iy, Floats);
  const Words hx = Words(ix) * 0x9e3779b1U + seed;
  const Words hy = Words(iy) * 0x85ebca77U;
  const Words hx1 = hx + 0x9e3779b1U;
  const Words hy1 = hy + 0x85ebca77U;
  const Floats n00 = cornerTerm<Lanes>(hx ^ hy, dx, dy);
  const Floats n10 = cornerTerm<Lanes>(hx1 ^ hy, dx - 1.0F, dy);
  const Floats n01 = cornerTerm<Lanes>(hx ^ hy1, dx, dy - 1.0F);
  const Floats n11 = cornerTerm<Lanes>(hx1 ^ hy1, dx - 1.0F, dy - 1.0F);
  const Floats u = fadeCurve(dx);
  const Floats v = fadeCurve(dy);
  const Floats bottom = n00 + u * (n10 - n00);
  const Floats top = n01 + u * (n11 - n01);
  return bottom + v * (top - bottom);
}

}  // namespace

CARTVO_TARGET_CLONES float noise(float x, float y, float footprint, const NoiseBand& band,
                                 std::uint32_t seed) {
  using Floats = Eight::Floats;
  using Words = Eight::Words;
  // The lattices of successive octaves are rotated, so that their axes do not form a visible grid.
  constexpr Floats kCosine{1.0F, 0.80F, 0.28F, -0.352F, 1.0F, 0.80F, 0.28F, -0.352F};
  constexpr Floats kSine{0.0F, 0.60F, 0.96F, 0.936F, 0.0F, 0.60F, 0.96F, 0.936F};
  constexpr Floats kDoubling{1.0F, 2.0F, 4.0F, 8.0F, 16.0F, 32.0F, 64.0F, 128.0F};
  constexpr Words kSeeds{0x68bc21ebU, 0xd17843d6U, 0x3a3465c1U, 0xa2f087acU,
                         0xcbe80796U, 0x34a42981U, 0x9d604b6cU, 0x061c6d57U};
  // An octave has its full amplitude below 0.3 cycles per pixel and none above 0.75.
  constexpr float kFadeEnd = 0.75F;
  constexpr float kFadeSlope = 1.0F / (kFadeEnd - 0.3F);
  const float g = band.gain;
  const float g2 = g * g;
  const float g4 = g2 * g2;
  const Floats gains{1.0F, g, g2, g2 * g, g4, g4 * g, g4 * g2, g4 * g2 * g};
  const Floats none{};
  const Floats whole = none + 1.0F;
  const float last = std::min(1.01F / band.shortest, kFadeEnd / footprint);
  float frequency = 1.0F / band.longest;
  float amplitude = band.first_amplitude * kInverseStddev;
  float sum = 0.0F;
  for (; frequency <= last; frequency *= 256.0F, amplitude *= g4 * g4, seed += 0xc657cb56U) {
    const Floats f = frequency * kDoubling;
    const Floats a = f <= last ? amplitude * gains : none;
    Floats kept = (kFadeEnd - f * footprint) * kFadeSlope;
    kept = kept > whole ? whole : kept;
    const Floats value =
        a * kept *
        gradientNoise<Eight>((kCosine * x - kSine * y) * f, (kSine * x + kCosine * y) * f, kSeeds + seed);
    sum += ((value[0] + value[1]) + (value[2] + value[3])) + ((value[4] + value[5]) + (value[6] + value[7]));
  }
  return sum;
}

CARTVO_TARGET_CLONES std::array<float, 4> unfadedNoises(float x, float y,
                                                        const std::array<float, 4>& wavelengths,
                                                        std::uint32_t seed) {
  using Floats = Four::Floats;
  using Words = Four::Words;
  constexpr Floats kCosine{1.0F, 0.80F, 0.28F, -0.352F};
  constexpr Floats kSine{0.0F, 0.60F, 0.96F, 0.936F};
  constexpr Words kSeeds{0x68bc21ebU, 0xd17843d6U, 0x3a3465c1U, 0xa2f087acU};
  const Floats f = 1.0F / Floats{wavelengths[0], wavelengths[1], wavelengths[2], wavelengths[3]};
  const Floats value =
      2.0F * gradientNoise<Four>((kCosine * x - kSine * y) * f, (kSine * x + kCosine * y) * f, kSeeds + seed);
  return {value[0], value[1], value[2], value[3]};
}

}  // namespace cartvo::world
