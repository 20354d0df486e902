#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "vo_core/geometry/fixed_vector.hpp"
#include "vo_core/image/affine_alignment.hpp"
#include "vo_core/image/image_pyramid.hpp"
#include "vo_core/odometry_settings.hpp"

// Affine alignment of several patches at once, in px of the full image.

namespace cartvo::vo {

/// Two pyramids and the level in which a patch is aligned.
struct PatchView {
  const ImagePyramid& before;
  const ImagePyramid& after;
  int level;
};

/// Aligns up to kCapacity patches together, each in its own pyramid level, which is faster than one by one.
/// Positions and variances are in px and px^2 of the full image.
class AlignmentBlock {
 public:
  static constexpr std::size_t kCapacity = 16;

  /// Adds patch `index`, below kCapacity. Does nothing if one of the images is too small to have the level.
  void add(std::size_t index, const PatchView& view, const Eigen::Vector2d& from, AffineAlignment start) {
    if (!bothHave(view.before, view.after, view.level)) return;
    const double scale = levelScale(view.level);
    start.position /= scale;
    tasks_.push_back({&view.before.grey[view.level], &view.after.grey[view.level], from / scale, start});
    members_.push_back({index, scale});
  }

  /// Calls handle(index, alignment) for each patch that aligned, in the order in which they were added.
  template <typename Handler>
  void align(const TrackingSettings& tracking, const Handler& handle) {
    alignAffine({tasks_.begin(), tasks_.size()}, tracking.iterations, tracking.convergence,
                {aligned_.data(), tasks_.size()});
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      if (!aligned_[i]) continue;
      aligned_[i]->position *= members_[i].scale;
      aligned_[i]->variance *= members_[i].scale * members_[i].scale;
      handle(members_[i].index, *aligned_[i]);
    }
  }

 private:
  struct Member {
    std::size_t index;
    double scale;  ///< px of the image per px of the level
  };

  FixedVector<AlignmentTask, kCapacity> tasks_;
  FixedVector<Member, kCapacity> members_;
  std::array<std::optional<AffineAlignment>, kCapacity> aligned_;
};

/// Whether the backward alignment ends at the start.
inline bool isConsistentBackward(const AffineAlignment& found, const TrackingSettings& tracking) {
  return found.forward_backward_error <= tracking.maximum_backward_error;
}

}  // namespace cartvo::vo
