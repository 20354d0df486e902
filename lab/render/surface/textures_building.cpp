// Textures of buildings. Texture coordinates: m along the wall and up from the ground.
#include "lab/render/surface/hash.hpp"
#include "lab/render/surface/material_textures.hpp"
#include "lab/render/surface/patterns.hpp"

namespace cartvo::world::textures {
namespace {

/// Streaks and dirt by rain: stretched along v, stronger near the ground.
float weathering(const SurfacePoint& p, float strength) {
  const float streaks = noise(p.u, 0.15F * p.v, p.footprint, {6.4F, 0.05F, 0.85F}, p.seed + 91U);
  const float splash = 1.0F - 0.3F * smoothStep(0.9F, 0.0F, p.v);
  return clampedExp(strength * streaks) * splash;
}

}  // namespace

float brick(const SurfacePoint& p, const TextureStyle& style) {
  constexpr float kLength = 0.25F;
  constexpr float kCourse = 0.078F;
  const float y = p.v / kCourse;
  const float width_y = p.width_v / kCourse;
  const CellBlend course = blendCells(y, width_y);
  const float width_x = p.width_u / kLength;
  const auto course_tone = [&](std::int32_t j) {
    const float x = p.u / kLength + ((j & 1) != 0 ? 0.5F : 0.0F);
    const CellBlend cell = blendCells(x, width_x);
    const auto tone = [&](std::int32_t i) {
      const std::uint32_t h = hashOf({p.seed, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)});
      return signedFloat(h) + (unitFloat(mixBits(h)) > 0.93F ? -1.3F : 0.0F);
    };
    const float t = mix(tone(cell.first), tone(cell.second), cell.share_of_second);
    const float face = clampedExp(0.34F * style.contrast * cell.contrast * course.contrast * t);
    return mix(face, 2.0F, filteredPulseTrain(0.045F, x, width_x));
  };
  float r = mix(course_tone(course.first), course_tone(course.second), course.share_of_second);
  r = mix(r, 2.0F, filteredPulseTrain(0.14F, y, width_y));
  const float base = 0.14F + 0.12F * p.tone;
  return base * r * weathering(p, 0.16F * style.contrast) *
         noiseFactor(p, {8.0F, 0.015F, 0.85F}, 0.22F * style.contrast, 2U);
}

float concrete(const SurfacePoint& p, const TextureStyle& style) {
  constexpr float kPanelU = 2.4F;
  constexpr float kPanelV = 1.5F;
  const CellBlend column = blendCells(p.u / kPanelU, p.width_u / kPanelU);
  const CellBlend row = blendCells(p.v / kPanelV, p.width_v / kPanelV);
  const auto tone = [&](std::int32_t i, std::int32_t j) {
    return signedFloat(hashOf({p.seed, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)}));
  };
  const auto row_tone = [&](std::int32_t j) {
    return mix(tone(column.first, j), tone(column.second, j), column.share_of_second);
  };
  const float t = mix(row_tone(row.first), row_tone(row.second), row.share_of_second);
  float r = (0.26F + 0.2F * p.tone) * clampedExp(0.16F * style.contrast * column.contrast * row.contrast * t);
  r *= 1.0F - 0.7F * filteredPulseTrain(0.012F, p.u / kPanelU, p.width_u / kPanelU);
  r *= 1.0F - 0.7F * filteredPulseTrain(0.018F, p.v / kPanelV, p.width_v / kPanelV);
  return r * weathering(p, 0.28F * style.contrast) *
         noiseFactor(p, {6.4F, 0.012F, 0.95F}, 0.24F * style.contrast, 3U);
}

float plaster(const SurfacePoint& p, const TextureStyle& style) {
  const float base =
      (0.38F + 0.3F * p.tone) * noiseFactor(p, {9.6F, 0.012F, 0.95F}, 0.20F * style.contrast, 4U);
  const auto shape = unfadedNoises(p.u, p.v, {2.1F, 0.33F, 5.0F, 0.9F}, p.seed + 41U);
  const float crack = filteredLine(shape[0] * 0.9F + 0.05F * shape[1], 0.008F, p.footprint);
  const float flaked = smoothStep(0.55F, 0.7F, shape[2] + 0.25F * shape[3] + 0.1F * shape[1]);
  const float worn = mix(base, 0.22F, 0.6F * flaked * style.contrast);
  return worn * (1.0F - 0.5F * style.contrast * crack * smoothStep(0.0F, 0.3F, shape[3])) *
         weathering(p, 0.22F * style.contrast);
}

float window(const SurfacePoint& p, const TextureStyle& style) {
  // p.u and p.v: m within one window including its frame, which is 6 cm wide.
  const float width = 1.0F + 0.6F * p.tone;
  const float height = 1.5F;
  const std::uint32_t h = hashOf({p.seed, 51U});
  const float inside = filteredPulse(0.06F, width - 0.06F, p.u, p.width_u) *
                       filteredPulse(0.06F, height - 0.06F, p.v, p.width_v);
  const float post = filteredLine(p.u - 0.5F * width, 0.06F, p.width_u);
  const float bar =
      unitFloat(mixBits(h + 1)) > 0.5F ? filteredLine(p.v - 0.68F * height, 0.05F, p.width_v) : 0.0F;
  const float frame = 1.0F - inside * (1.0F - post) * (1.0F - bar);
  const float frame_tone = unitFloat(h) > 0.35F ? 0.55F : 0.07F;
  // Behind the glass: a dark room with shapes in it and, in some windows, a blind at some height.
  float room =
      0.05F * clampedExp(0.8F * style.contrast * noise(p.u, p.v, p.footprint, {1.6F, 0.05F, 0.75F}, h + 2));
  const float blind_bottom = height * (0.2F + 1.1F * unitFloat(mixBits(h + 3)));
  const float slats = 0.30F * (1.0F - 0.45F * filteredPulseTrain(0.3F, p.v / 0.06F, p.width_v / 0.06F));
  room = mix(room, slats, filteredStep(blind_bottom, p.v, p.width_v));
  return mix(room, frame_tone, frame);
}

float door(const SurfacePoint& p, const TextureStyle& style) {
  const float panel_u = filteredPulse(0.15F, 0.85F, p.u, p.width_u);
  const float panel_v = filteredPulse(0.2F, 0.9F, p.v, p.width_v) + filteredPulse(1.1F, 1.9F, p.v, p.width_v);
  const float handle =
      filteredPulse(0.86F, 0.96F, p.u, p.width_u) * filteredPulse(1.0F, 1.06F, p.v, p.width_v);
  const float leaf_tone = (0.08F + 0.3F * p.tone) * (1.0F - 0.3F * panel_u * panel_v);
  return mix(leaf_tone, 0.7F, handle) * noiseFactor(p, {1.6F, 0.02F, 0.8F}, 0.15F * style.contrast, 5U);
}

float roof(const SurfacePoint& p, const TextureStyle& style) {
  const CellBlend column = blendCells(p.u / 0.3F, p.width_u / 0.3F);
  const CellBlend row = blendCells(p.v / 0.35F, p.width_v / 0.35F);
  const auto tone = [&](std::int32_t i, std::int32_t j) {
    return signedFloat(hashOf({p.seed, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j), 61U}));
  };
  const float t =
      mix(mix(tone(column.first, row.first), tone(column.second, row.first), column.share_of_second),
          mix(tone(column.first, row.second), tone(column.second, row.second), column.share_of_second),
          row.share_of_second);
  const float shade = filteredPulseTrain(0.18F, p.v / 0.35F, p.width_v / 0.35F);
  return (0.12F + 0.12F * p.tone) * clampedExp(0.3F * column.contrast * row.contrast * t) *
         (1.0F - 0.45F * shade) * noiseFactor(p, {9.6F, 0.05F, 0.9F}, 0.25F * style.contrast, 6U);
}

}  // namespace cartvo::world::textures
