#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

// Shapes with sharp edges (steps, pulses, lines, cells) filtered by a box as wide as the pixel, in closed
// form. All lengths have the same unit; widths > 0.
namespace cartvo::world {

/// Mean over [x - width/2, x + width/2] of a step that is 0 below `edge` and 1 above.
inline float filteredStep(float edge, float x, float width) {
  return std::clamp((x - edge) / width + 0.5F, 0.0F, 1.0F);
}

/// Mean over the same interval of a pulse that is 1 in [from, to].
inline float filteredPulse(float from, float to, float x, float width) {
  return filteredStep(from, x, width) - filteredStep(to, x, width);
}

/// Cubic step from 0 at `from` to 1 at `to` with zero slope at both.
inline float smoothStep(float from, float to, float x) {
  const float t = std::clamp((x - from) / (to - from), 0.0F, 1.0F);
  return t * t * (3.0F - 2.0F * t);
}

/// Mean over [x - width/2, x + width/2] of a pulse train: 1 in the first `duty` of each period of 1. A box
/// filter passes frequencies above the Nyquist limit: at 1.5 pixels per period 40 % of the first harmonic
/// remains and aliases. The train therefore fades to its mean before the period is two pixels.
inline float filteredPulseTrain(float duty, float x, float width) {
  constexpr float kFadeStart = 0.3F;
  constexpr float kFadeEnd = 0.6F;
  const float faded = smoothStep(kFadeStart, kFadeEnd, width);
  if (faded >= 1.0F) return duty;
  const auto integral = [duty](float at) {
    const float whole = std::floor(at);
    return whole * duty + std::min(at - whole, duty);
  };
  const float share = (integral(x + 0.5F * width) - integral(x - 0.5F * width)) / width;
  return share + faded * (duty - share);
}

/// Mean over the pixel of a line of `thickness` at `distance` from its centre.
inline float filteredLine(float distance, float thickness, float width) {
  return filteredPulse(-0.5F * thickness, 0.5F * thickness, distance, width);
}

/// The two cells of width 1 that a pixel covers. `contrast` falls to 0 as the pixel becomes wider than a
/// cell; the caller multiplies the cells' deviation from their mean by it.
struct CellBlend {
  std::int32_t first = 0;
  std::int32_t second = 0;
  float share_of_second = 0.0F;
  float contrast = 1.0F;
};

inline CellBlend blendCells(float x, float width) {
  CellBlend blend;
  const float w = std::min(width, 1.0F);
  const float low = std::floor(x - 0.5F * w);
  const float high = std::floor(x + 0.5F * w);
  blend.first = static_cast<std::int32_t>(low);
  blend.second = static_cast<std::int32_t>(high);
  if (high > low) blend.share_of_second = (x + 0.5F * w - high) / w;
  blend.contrast = std::clamp(1.6F - 1.7F * width, 0.0F, 1.0F);
  return blend;
}

}  // namespace cartvo::world
