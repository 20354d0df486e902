#pragma once

#include <array>
#include <cstdint>

// Band-limited noise: a sum of octaves of gradient noise (K. Perlin, "Improving noise", 2002). Each octave
// fades out before the pixel's footprint undersamples it, so that one evaluation per pixel does not alias.
namespace cartvo::world {

/// The octaves of a noise. Evaluated at compile time, so that its normalisation costs nothing at run time.
struct NoiseBand {
  /// Wavelengths of the first and the last octave, m; each octave has half the wavelength of the one before
  /// and `octave_gain` times its amplitude (natural textures: 0.7 to 1).
  consteval NoiseBand(float longest_wavelength, float shortest_wavelength, float octave_gain)
      : longest(longest_wavelength), shortest(shortest_wavelength), gain(octave_gain) {
    double variance = 0.0;
    double amplitude = 1.0;
    for (double wavelength = longest; wavelength >= shortest / 1.01; wavelength *= 0.5) {
      variance += amplitude * amplitude;
      amplitude *= gain;
    }
    double root = variance;  // Newton's method: std::sqrt is not constexpr
    for (int i = 0; i < 20; ++i)
      root = 0.5 * (root + variance / root);
    first_amplitude = static_cast<float>(1.0 / root);
  }

  float longest;
  float shortest;
  float gain;
  float first_amplitude = 1.0F;  ///< normalises the sum of the octaves' variances to 1
};

/// Noise of about normal distribution with zero mean, and unit variance where no octave is faded. (x, y):
/// position on the surface, m; `footprint`: width of the pixel on it, m.
float noise(float x, float y, float footprint, const NoiseBand& band, std::uint32_t seed);

/// Four independent octaves without fading, each about -1..1: for shapes (cracks, edges, wear).
std::array<float, 4> unfadedNoises(float x, float y, const std::array<float, 4>& wavelengths,
                                   std::uint32_t seed);

}  // namespace cartvo::world
