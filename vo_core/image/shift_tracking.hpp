#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "vo_core/image/image_pyramid.hpp"

// Pyramidal tracking of patches by a pure shift (KLT).

namespace cartvo::vo {

/// Range of pyramid levels, both ends included.
struct PyramidLevels {
  int finest = 0;
  int coarsest = 0;
};

/// A patch to track: the one around `from` in `before`, starting at `guess` in `after`; px of the full image.
struct ShiftTask {
  const ImagePyramid* before = nullptr;
  const ImagePyramid* after = nullptr;
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  Eigen::Vector2d guess = Eigen::Vector2d::Zero();
  PyramidLevels levels;
};

/// Tracks 15x15 patches by a pure shift to a tenth of a pixel of the finest level, in which they must
/// correlate by `minimum_correlation`. From the coarsest level (a good guess needs few levels) to the finest,
/// the sum of squared differences over the shift d is minimised (thesis 4.10-4.13: G d = b with the structure
/// matrix G of the patch's gradients), with a change of brightness removed. The result is nothing if the
/// patch has no texture, leaves the image or correlates less, and the guess if the images are too small to
/// have any of the levels. Each patch has the same result as alone; together they are faster. `shifted` has
/// the size of `tasks`; px.
///
/// The patch before is the one that is linearised (S. Baker, I. Matthews, "Lucas-Kanade 20 years on", 2004,
/// inverse compositional).
void trackShifts(std::span<const ShiftTask> tasks, double minimum_correlation,
                 std::span<std::optional<Eigen::Vector2d>> shifted);

/// Tracks one patch.
std::optional<Eigen::Vector2d> trackShift(const ShiftTask& task, double minimum_correlation);

}  // namespace cartvo::vo
