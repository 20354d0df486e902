#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

// Sharp shapes (lines, bricks, steps) averaged over a pixel's width in closed form: what a box filter of that
// width would make of them. All lengths in the same unit, widths > 0.
namespace cartvo::world {

/// Average over [x - width/2, x + width/2] of a step that is 0 below `edge` and 1 above.
inline float filteredStep(float edge, float x, float width) {
  return std::clamp((x - edge) / width + 0.5F, 0.0F, 1.0F);
}

/// The same of a pulse that is 1 in [from, to].
inline float filteredPulse(float from, float to, float x, float width) {
  return filteredStep(from, x, width) - filteredStep(to, x, width);
}

/// 0 at `from`, 1 at `to`, with zero slope at both.
inline float smoothStep(float from, float to, float x) {
  const float t = std::clamp((x - from) / (to - from), 0.0F, 1.0F);
  return t * t * (3.0F - 2.0F * t);
}

/// The same of a train of pulses, 1 in the first `duty` of each period of 1. A box lets through what a pixel
/// cannot show: at 1.5 pixels a period it still leaves 40 % of the first harmonic, which then runs the wrong
/// way. So the train fades to its mean before there are but two pixels to a period.
inline float filteredPulseTrain(float duty, float x, float width) {
  constexpr float kWhole = 0.3F;
  constexpr float kGone = 0.6F;
  const float faded = smoothStep(kWhole, kGone, width);
  if (faded >= 1.0F) return duty;
  const auto integral = [duty](float at) {
    const float whole = std::floor(at);
    return whole * duty + std::min(at - whole, duty);
  };
  const float share = (integral(x + 0.5F * width) - integral(x - 0.5F * width)) / width;
  return share + faded * (duty - share);
}

/// A line of `thickness` at `distance` from the pixel's centre.
inline float filteredLine(float distance, float thickness, float width) {
  return filteredPulse(-0.5F * thickness, 0.5F * thickness, distance, width);
}

/// The two cells of width 1 under a pixel and the share of the second. Where the pixel is wider than a cell
/// the caller fades to the cells' mean by `contrast`.
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
