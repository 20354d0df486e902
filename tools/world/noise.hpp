#pragma once

#include <array>
#include <cstdint>

// Band-limited noise: the sum of octaves of gradient noise (K. Perlin, "Improving noise", 2002), each faded
// out before the pixel's footprint can no longer show it, so that one evaluation a pixel does not alias.
namespace cartvo::world {

/// Which octaves a noise holds. Always a constant, so that its amplitude costs nothing where it is used.
struct NoiseBand {
  /// Wavelengths of the first and the last octave, m, each half as long as the one before, and the amplitude
  /// from octave to octave; natural textures lie at 0.7-1.
  consteval NoiseBand(float longest_wavelength, float shortest_wavelength, float octave_gain)
      : longest(longest_wavelength), shortest(shortest_wavelength), gain(octave_gain) {
    double variance = 0.0;
    double amplitude = 1.0;
    for (double wavelength = longest; wavelength >= shortest / 1.01; wavelength *= 0.5) {
      variance += amplitude * amplitude;
      amplitude *= gain;
    }
    double root = variance;  // Newton's method: there is no constant square root
    for (int i = 0; i < 20; ++i)
      root = 0.5 * (root + variance / root);
    first_amplitude = static_cast<float>(1.0 / root);
  }

  float longest;
  float shortest;
  float gain;
  float first_amplitude = 1.0F;  ///< that makes the octaves' variances add up to 1
};

/// About normal, zero mean; unit variance where every octave is seen. (x, y) in m on the surface, `footprint`
/// is the width of the pixel there, m.
float noise(float x, float y, float footprint, const NoiseBand& band, std::uint32_t seed);

/// Four single octaves, not faded, each about -1..1: for shapes (cracks, edges, wear).
std::array<float, 4> plainNoises(float x, float y, const std::array<float, 4>& wavelengths,
                                 std::uint32_t seed);

}  // namespace cartvo::world
