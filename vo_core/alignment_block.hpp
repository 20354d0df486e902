#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "vo_core/affine_alignment.hpp"
#include "vo_core/fixed_vector.hpp"
#include "vo_core/image_pyramid.hpp"
#include "vo_core/odometry_settings.hpp"

namespace cartvo {

/// Where a patch is compared: between these, in that level of both.
struct PatchView {
  const ImagePyramid& before;
  const ImagePyramid& after;
  int level;
};

/// Patches that are aligned together, each in its own level of the pyramids, which is faster than one by one;
/// positions and their variances are of the image.
class AlignmentBlock {
 public:
  static constexpr std::size_t kMost = 16;

  /// The patch `index`, below kMost. Images too small to have the level align nothing.
  void add(std::size_t index, const PatchView& view, const Eigen::Vector2d& from, AffineAlignment start) {
    if (!bothHave(view.before, view.after, view.level)) return;
    const double scale = levelScale(view.level);
    start.position /= scale;
    tasks_.push_back({&view.before.grey[view.level], &view.after.grey[view.level], from / scale, start});
    members_.push_back({index, scale});
  }

  /// Calls take(index, alignment) for those patches that align, in the order in which they were added.
  template <typename Take>
  void align(WarpModel model, const TrackingSettings& tracking, const Take& take) {
    alignAffine({tasks_.begin(), tasks_.size()}, model, tracking.iterations, tracking.convergence,
                {aligned_.data(), tasks_.size()});
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      if (!aligned_[i]) continue;
      aligned_[i]->position *= members_[i].scale;
      aligned_[i]->variance *= members_[i].scale * members_[i].scale;
      take(members_[i].index, *aligned_[i]);
    }
  }

 private:
  struct Member {
    std::size_t index;
    double scale;  ///< px of the image for each of the level
  };

  FixedVector<AlignmentTask, kMost> tasks_;
  FixedVector<Member, kMost> members_;
  std::array<std::optional<AffineAlignment>, kMost> aligned_;
};

}  // namespace cartvo
