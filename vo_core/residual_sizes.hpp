#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "vo_core/bundle_residuals.hpp"
#include "vo_core/size_histogram.hpp"

// Not for use outside the bundle adjustment.

namespace cartvo {

/// How large the residuals are, of all landmarks of a level and of each one's last sighting.
class ResidualSizes {
 public:
  void reset(const BundleBlocks& blocks) {
    for (ByLevel* sizes : {&pixels_, &disparities_})
      for (SizeHistogram& of_level : *sizes)
        of_level.clear();
    last_.clear();
    last_.reserve(blocks.landmarks.capacity());
  }

  // Visits of ReducedSystem::build().
  void begin(const LandmarkBlock& block) {
    block_ = &block;
    last_.emplace_back();
  }

  void add(const BlockView& view, const SightingRows& rows) {
    Last& last = last_.back();
    if (!view.isHost()) {
      const DoubleLanes& column = rows.row[SightingRows::kColumn].residual;
      const DoubleLanes& row = rows.row[SightingRows::kRow].residual;
      add(view.seen, column, pixels_);
      add(view.seen, row, pixels_);
      last.squares += view.seen * (column * column + row * row - last.squares);
      last.count += view.seen * (2.0 - last.count);
    }
    const DoubleLanes& disparity = rows.row[SightingRows::kDisparity].residual;
    add(view.stereo, disparity, disparities_);
    last.squares += view.stereo * (disparity * disparity);
    last.count += view.stereo;
  }

  /// rms of a landmark's last sighting.
  double lastError(std::size_t block, int lane) const {
    const double count = last_[block].count[lane];
    return count > 0.0 ? std::sqrt(last_[block].squares[lane] / count) : 0.0;
  }

  void conclude(BundleResult& result) const {
    for (int level = 0; level < kLandmarkLevels; ++level)
      result.noise_scale[level] = {scaleOf(pixels_, level), scaleOf(disparities_, level)};
  }

 private:
  using ByLevel = std::array<SizeHistogram, kLandmarkLevels>;
  static constexpr int kEnough = 30;  ///< residuals, of which a level knows its noise

  struct Last {
    DoubleLanes squares{}, count{};
  };

  void add(const DoubleLanes& counts, const DoubleLanes& residual, ByLevel& sizes) const {
    for (int lane = 0; lane < kDoubleLanes; ++lane)
      if (counts[lane] > 0.0) sizes[block_->level[lane]].add(std::abs(residual[lane]));
  }

  /// A level that has too few goes with the one that has most.
  static double scaleOf(const ByLevel& sizes, int level) {
    const SizeHistogram* told = &sizes[level];
    if (told->count() < kEnough)
      told = &*std::max_element(sizes.begin(), sizes.end(),
                                [](const auto& a, const auto& b) { return a.count() < b.count(); });
    return told->count() == 0 ? 1.0 : told->deviation();
  }

  ByLevel pixels_, disparities_;
  std::vector<Last> last_;
  const LandmarkBlock* block_ = nullptr;  ///< the present one
};

}  // namespace cartvo
