#pragma once

#include <cstdint>
#include <initializer_list>

// Hash functions and a random generator: pseudo-random numbers that depend on their arguments alone, so that
// a campus is the same in each run.
namespace cartvo::world {

/// Bijective hash of 32 bits: lowbias32 of C. Wellons, "Prospecting for hash functions".
constexpr std::uint32_t mixBits(std::uint32_t x) {
  x ^= x >> 16U;
  x *= 0x7feb352dU;
  x ^= x >> 15U;
  x *= 0x846ca68bU;
  x ^= x >> 16U;
  return x;
}

/// Hash of a sequence of values; depends on their order.
constexpr std::uint32_t hashOf(std::initializer_list<std::uint32_t> values) {
  std::uint32_t h = 0x9e3779b9U;
  for (const std::uint32_t value : values)
    h = mixBits(h ^ (value + 0x9e3779b9U + (h << 6U) + (h >> 2U)));
  return h;
}

/// Maps the upper 24 bits to [0, 1).
constexpr float unitFloat(std::uint32_t bits) {
  return static_cast<float>(bits >> 8U) * 0x1p-24F;
}

/// Maps the upper 24 bits to [-1, 1).
constexpr float signedFloat(std::uint32_t bits) {
  return 2.0F * unitFloat(bits) - 1.0F;
}

/// Pseudo-random generator splitmix64 (S. Vigna).
class Random {
 public:
  explicit constexpr Random(std::uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15ULL + 1) {}

  constexpr std::uint32_t bits() {
    state_ += 0x9e3779b97f4a7c15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
    return static_cast<std::uint32_t>((z ^ (z >> 31U)) >> 32U);
  }
  constexpr double uniform(double from, double to) { return from + (to - from) * unitFloat(bits()); }
  constexpr float real(double from, double to) { return static_cast<float>(uniform(from, to)); }
  constexpr bool chance(double probability) { return unitFloat(bits()) < probability; }
  constexpr int below(int count) { return static_cast<int>(unitFloat(bits()) * static_cast<float>(count)); }

 private:
  std::uint64_t state_;
};

}  // namespace cartvo::world
