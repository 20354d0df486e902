// Textures of trees, vehicles, people and street furniture.
#include "lab/render/surface/hash.hpp"
#include "lab/render/surface/material_textures.hpp"
#include "lab/render/surface/patterns.hpp"

namespace cartvo::world::textures {

float wood(const SurfacePoint& p, const TextureStyle& style) {
  const float grain = noise(p.u * 0.12F, p.v, p.footprint, {0.4F, 0.006F, 0.8F}, p.seed * 0x9e3779b1U + 1U);
  const float stains = noiseFactor(p, {3.2F, 0.05F, 0.9F}, 0.25F, 2U);
  return (0.14F + 0.25F * p.tone) * clampedExp(0.28F * style.contrast * grain) * stains;
}

float metal(const SurfacePoint& p, const TextureStyle& style) {
  return (0.1F + 0.4F * p.tone) * noiseFactor(p, {1.6F, 0.01F, 0.9F}, 0.25F * style.contrast, 7U);
}

float bark(const SurfacePoint& p, const TextureStyle& style) {
  const float ridges =
      noise(p.u, 0.22F * p.v, p.footprint, {0.32F, 0.008F, 0.85F}, p.seed * 0x9e3779b1U + 8U);
  const float moss = noise(p.u, p.v, p.footprint, {1.6F, 0.1F, 0.8F}, p.seed * 0x9e3779b1U + 9U);
  return 0.14F * clampedExp(0.55F * style.contrast * ridges + 0.25F * moss);
}

float leaf(const SurfacePoint& p, const TextureStyle& style) {
  const float own = signedFloat(mixBits(p.seed));
  float r = 0.15F * clampedExp(0.38F * (0.4F + 0.6F * style.contrast) * own + 0.5F * (p.tone - 0.5F));
  if (p.footprint < 0.02F) {
    r *= clampedExp(0.25F * noise(p.u, p.v, p.footprint, {0.16F, 0.02F, 0.8F}, p.seed));
    r *= 1.0F + 0.3F * filteredLine(p.u, 0.006F, p.footprint);
  }
  return r;
}

float paint(const SurfacePoint& p, const TextureStyle& style) {
  const float dirt = noise(p.u, p.v, p.footprint, {1.6F, 0.02F, 0.8F}, p.seed * 0x9e3779b1U + 10U);
  return (0.05F + 0.6F * p.tone * p.tone) * clampedExp(0.12F * style.contrast * dirt);
}

float glass(const SurfacePoint& p, const TextureStyle& style) {
  return 0.05F * noiseFactor(p, {0.8F, 0.05F, 0.8F}, 0.5F * style.contrast, 11U);
}

float rubber(const SurfacePoint& p, const TextureStyle& style) {
  return 0.04F * noiseFactor(p, {0.4F, 0.02F, 0.8F}, 0.4F * style.contrast, 12U);
}

float cloth(const SurfacePoint& p, const TextureStyle& style) {
  const float weave = noise(p.u, 0.5F * p.v, p.footprint, {0.6F, 0.02F, 0.85F}, p.seed * 0x9e3779b1U + 13U);
  const float stripes = unitFloat(mixBits(p.seed)) > 0.6F
                            ? 0.5F * filteredPulseTrain(0.5F, p.v / 0.11F, p.width_v / 0.11F)
                            : 0.0F;
  return (0.06F + 0.4F * p.tone) * clampedExp(0.3F * style.contrast * weave - stripes);
}

float sign(const SurfacePoint& p, const TextureStyle& style) {
  // A bright board with a dark border and rows of dark strokes that resemble text.
  const float size = 0.6F;
  const float inside =
      filteredPulse(0.03F, size - 0.03F, p.u, p.width_u) * filteredPulse(0.03F, size - 0.03F, p.v, p.width_v);
  const CellBlend row = blendCells(p.v / 0.13F, p.width_v / 0.13F);
  const CellBlend letter = blendCells(p.u / 0.05F, p.width_u / 0.05F);
  const std::uint32_t h =
      hashOf({p.seed, static_cast<std::uint32_t>(row.first), static_cast<std::uint32_t>(letter.first)});
  const float stroke =
      (unitFloat(h) < 0.75F ? 1.0F : 0.0F) * filteredPulseTrain(0.55F, p.v / 0.13F, p.width_v / 0.13F) *
      filteredPulseTrain(0.3F + 0.4F * unitFloat(mixBits(h)), p.u / 0.05F, p.width_u / 0.05F);
  const float margin =
      filteredPulse(0.08F, size - 0.08F, p.u, p.width_u) * filteredPulse(0.08F, size - 0.08F, p.v, p.width_v);
  const float board = mix(0.65F, 0.08F, stroke * margin);
  return mix(0.08F, board, inside) * noiseFactor(p, {0.8F, 0.02F, 0.8F}, 0.1F * style.contrast, 14U);
}

}  // namespace cartvo::world::textures
