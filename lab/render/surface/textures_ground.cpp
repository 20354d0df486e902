// Textures of the ground: asphalt with markings, patches and cracks; kerb stones; slabs; grass.
#include "lab/render/surface/hash.hpp"
#include "lab/render/surface/material_textures.hpp"
#include "lab/render/surface/patterns.hpp"

namespace cartvo::world::textures {
namespace {

// Lateral positions of the lane markings, m left of the path.
constexpr float kLaneDivide = 1.7F;
constexpr float kRightLine = -1.75F;

/// A repaired rectangle of asphalt, in some of the cells of 7 m along the road.
struct Patch {
  float cover = 0.0F;  ///< fraction of the pixel that is patch
  float seam = 0.0F;   ///< fraction of the pixel that is its seam
  float tone = 1.0F;   ///< factor on the reflectance
};

Patch patchAt(const SurfacePoint& p, std::uint32_t seed) {
  constexpr float kCell = 7.0F;
  const auto cell = static_cast<std::int32_t>(std::floor(p.u / kCell));
  const std::uint32_t h = hashOf({seed, static_cast<std::uint32_t>(cell)});
  Patch patch;
  if (unitFloat(h) > 0.45F) return patch;
  const float length = 1.0F + 3.0F * unitFloat(mixBits(h + 1));
  const float width = 0.5F + 1.6F * unitFloat(mixBits(h + 2));
  const float from_u =
      static_cast<float>(cell) * kCell + 0.3F + (kCell - 0.6F - length) * unitFloat(mixBits(h + 3));
  const float from_v = -1.6F + 6.0F * unitFloat(mixBits(h + 4));
  const auto box = [&](float margin) {
    return filteredPulse(from_u - margin, from_u + length + margin, p.u, p.width_u) *
           filteredPulse(from_v - margin, from_v + width + margin, p.v, p.width_v);
  };
  patch.cover = box(0.0F);
  patch.seam = box(0.025F) - patch.cover;
  patch.tone = 0.62F + 0.3F * unitFloat(mixBits(h + 5));
  return patch;
}

/// Factor on the reflectance by a round iron cover, in some of the cells of 23 m along the road.
float manhole(const SurfacePoint& p, std::uint32_t seed) {
  constexpr float kCell = 23.0F;
  const auto cell = static_cast<std::int32_t>(std::floor(p.u / kCell));
  const std::uint32_t h = hashOf({seed, static_cast<std::uint32_t>(cell), 77U});
  if (unitFloat(h) > 0.7F) return 1.0F;
  const float u = p.u - (static_cast<float>(cell) + 0.1F + 0.8F * unitFloat(mixBits(h + 1))) * kCell;
  const float v = p.v - (0.2F + 2.6F * unitFloat(mixBits(h + 2)));
  const float r = std::sqrt(u * u + v * v);
  if (r > 0.6F) return 1.0F;
  const float disc = 1.0F - filteredStep(0.34F, r, p.footprint);
  const float rim = filteredPulse(0.31F, 0.35F, r, p.footprint) + filteredPulse(0.40F, 0.43F, r, p.footprint);
  const float studs = filteredPulseTrain(0.5F, u * 16.0F, p.width_u * 16.0F) *
                      filteredPulseTrain(0.5F, v * 16.0F, p.width_v * 16.0F);
  return mix(1.0F, 0.55F + 0.5F * studs, disc) * (1.0F - 0.6F * std::clamp(rim, 0.0F, 1.0F));
}

/// Fraction of the pixel under white paint, before wear.
float markings(const SurfacePoint& p) {
  const float dashes = filteredPulseTrain(0.5F, p.u / 5.0F, p.width_u / 5.0F);
  return dashes * filteredLine(p.v - kLaneDivide, 0.12F, p.width_v) +
         filteredLine(p.v - kRightLine, 0.10F, p.width_v);
}

}  // namespace

float asphalt(const SurfacePoint& p, const TextureStyle& style) {
  const float grain = noise(p.x, p.y, p.footprint, {25.6F, 0.012F, 1.0F}, style.seed + 11U);
  float r = 0.17F * clampedExp(0.42F * style.contrast * grain);
  const float ruts = filteredPulse(0.45F, 1.0F, std::abs(p.v), 0.5F);
  r *= 1.0F - 0.12F * ruts;
  if (style.contrast > 0.5F) {
    const Patch patch = patchAt(p, style.seed + 13U);
    r *= mix(1.0F, patch.tone, patch.cover) * (1.0F - 0.65F * patch.seam);
    if (p.footprint < 0.12F) {
      const auto shape = unfadedNoises(p.x, p.y, {3.3F, 1.25F, 11.0F, 0.21F}, style.seed + 12U);
      const float wide = filteredLine(shape[0] * 1.4F + 0.03F * shape[3], 0.016F, p.footprint);
      const float fine = filteredLine(shape[1] * 0.5F + 0.03F * shape[3], 0.009F, p.footprint);
      r *= (1.0F - 0.7F * wide * smoothStep(0.05F, 0.25F, shape[2])) *
           (1.0F - 0.6F * fine * smoothStep(0.25F, 0.45F, shape[2]));
    }
    r *= manhole(p, style.seed + 14U);
  }
  const float painted = markings(p);
  if (painted > 0.0F) {
    const float wear = noise(p.x, p.y, p.footprint, {3.2F, 0.02F, 0.9F}, style.seed + 15U);
    const float kept = smoothStep(-1.6F, 0.1F, wear + 0.4F);
    r = mix(r, 0.55F * clampedExp(0.1F * wear), painted * (0.35F + 0.6F * kept));
  }
  return r;
}

float kerb(const SurfacePoint& p, const TextureStyle& style) {
  const CellBlend stone = blendCells(p.u / 0.9F, p.width_u / 0.9F);
  const auto tone = [&](std::int32_t i) {
    return 0.36F *
           clampedExp(0.3F * stone.contrast * signedFloat(hashOf({p.seed, static_cast<std::uint32_t>(i)})));
  };
  float r = mix(tone(stone.first), tone(stone.second), stone.share_of_second);
  const float joint = filteredPulseTrain(0.013F, p.u / 0.9F, p.width_u / 0.9F);
  r *= (1.0F - 0.7F * joint);
  return r * noiseFactor(p, {3.2F, 0.012F, 0.9F}, 0.28F * style.contrast, 1U);
}

float pavement(const SurfacePoint& p, const TextureStyle& style) {
  constexpr float kSlab = 0.5F;
  const CellBlend row = blendCells(p.v / kSlab, p.width_v / kSlab);
  const auto row_tone = [&](std::int32_t j) {
    const float shift = (j & 1) != 0 ? 0.5F : 0.0F;
    const CellBlend slab = blendCells(p.u / kSlab + shift, p.width_u / kSlab);
    const auto tone = [&](std::int32_t i) {
      return signedFloat(hashOf({p.seed, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)}));
    };
    const float joint = filteredPulseTrain(0.02F, p.u / kSlab + shift, p.width_u / kSlab);
    const float t = mix(tone(slab.first), tone(slab.second), slab.share_of_second);
    return clampedExp(0.24F * style.contrast * slab.contrast * row.contrast * t) * (1.0F - 0.6F * joint);
  };
  float r = 0.33F * mix(row_tone(row.first), row_tone(row.second), row.share_of_second);
  r *= 1.0F - 0.6F * filteredPulseTrain(0.02F, p.v / kSlab, p.width_v / kSlab);
  return r *
         clampedExp(0.26F * style.contrast * noise(p.x, p.y, p.footprint, {12.8F, 0.012F, 0.92F}, p.seed));
}

float grass(const SurfacePoint& p, const TextureStyle& style) {
  const float blades = noise(p.x, p.y, p.footprint, {38.4F, 0.018F, 0.95F}, style.seed + 31U);
  const float tufts = noise(p.x, p.y, p.footprint, {0.9F, 0.05F, 0.95F}, style.seed + 32U);
  const float bare =
      smoothStep(0.9F, 1.7F, noise(p.x, p.y, p.footprint, {9.0F, 0.5F, 0.7F}, style.seed + 33U));
  const float contrast = 0.35F + 0.65F * style.contrast;
  return mix(0.15F * clampedExp(contrast * (0.42F * blades + 0.28F * tufts)),
             0.26F * clampedExp(0.25F * contrast * blades), 0.7F * bare);
}

}  // namespace cartvo::world::textures
