#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "vo_core/image_pyramid.hpp"

namespace cartvo {

/// Levels of a pyramid, from the finest to the coarsest, both included.
struct PyramidLevels {
  int finest = 0;
  int coarsest = 0;
};

/// A patch to be followed: that around `from` in `before` to `after`, beginning at `guess`; px of the image.
struct ShiftTask {
  const ImagePyramid* before = nullptr;
  const ImagePyramid* after = nullptr;
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  Eigen::Vector2d guess = Eigen::Vector2d::Zero();
  PyramidLevels levels;
};

/// Where 15x15 patches have gone by a mere shift, to a tenth of a pixel of the finest level, where they must
/// correlate by `minimum_correlation`. Coarse to fine, beginning at the guess in the coarsest level (a good
/// guess needs few), the sum of squared differences over the shift d is minimised (thesis 4.10-4.13: G d = b
/// with the structure matrix G of the patch's gradients), with a change of brightness removed. Nothing: no
/// texture, left the image, or correlates less. Images too small to have any of the levels: the guess. Each
/// as it would be alone, but faster together. `shifted`: of the size of `tasks`; px.
///
/// The patch before is the one that is linearised (S. Baker, I. Matthews, "Lucas-Kanade 20 years on", 2004,
/// inverse compositional).
void trackShifts(std::span<const ShiftTask> tasks, double minimum_correlation,
                 std::span<std::optional<Eigen::Vector2d>> shifted);

/// The same of one.
std::optional<Eigen::Vector2d> trackShift(const ShiftTask& task, double minimum_correlation);

}  // namespace cartvo
