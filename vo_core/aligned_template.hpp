#pragma once

#include <Eigen/Core>

#include "vo_core/affine_alignment.hpp"
#include "vo_core/patch.hpp"

// The patches that shifts and alignments compare. Not for use outside tracking.

namespace cartvo {

/// Of the patch each other row is compared, which halves the work: neighbouring rows tell much the same.
constexpr int kAlignedRowStep = 2;
constexpr int kAlignedRows = (kPatchSide + kAlignedRowStep - 1) / kAlignedRowStep;
constexpr int kAlignedSize = kPatchSide * kAlignedRows;  ///< px
using AlignedPatch = Patch<kPatchSide, kAlignedRows>;
static_assert(AlignedPatch::kBlocks == 1, "a row is one vector of lanes");
constexpr Patch<kPatchSide, 1> kAlignedMask = AlignedPatch::mask();

/// The patch before and its gradients; all zero in the padding.
struct AlignedTemplate {
  AlignedPatch grey;  ///< without its mean
  AlignedPatch gradient_x, gradient_y;
  float mean = 0.0F;
};

/// `centre`: px of the level, inside it.
template <typename Processor>
void takeTemplate(const PyramidLevel& level, const Eigen::Vector2d& centre, AlignedTemplate& out) {
  sampleGradients<Processor, kAlignedRowStep>(level, centre, out.grey, out.gradient_x, out.gradient_y);
  out.mean = removeMean(out.grey);
}

}  // namespace cartvo
