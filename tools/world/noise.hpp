#pragma once

#include <array>
#include <cstdint>

// Band-limited noise: the sum of octaves of gradient noise (K. Perlin, "Improving noise", 2002), each faded
// out before the pixel's footprint can no longer show it, so that one evaluation a pixel does not alias.
namespace cartvo::world {

/// Which octaves a noise holds.
struct NoiseBand {
  float longest = 1.0F;   ///< wavelength of the first octave, m
  float shortest = 0.1F;  ///< wavelength of the last one, m; each is half as long as the one before
  float gain = 0.8F;      ///< amplitude from octave to octave; natural textures lie at 0.7-1
};

/// About normal, zero mean; unit variance where every octave is seen. (x, y) in m on the surface, `footprint`
/// is the width of the pixel there, m.
float noise(float x, float y, float footprint, const NoiseBand& band, std::uint32_t seed);

/// Four single octaves, not faded, each about -1..1: for shapes (cracks, edges, wear).
std::array<float, 4> plainNoises(float x, float y, const std::array<float, 4>& wavelengths,
                                 std::uint32_t seed);

}  // namespace cartvo::world
