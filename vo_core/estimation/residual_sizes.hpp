#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "vo_core/estimation/bundle_residuals.hpp"
#include "vo_core/geometry/size_histogram.hpp"

// Statistics of the residuals of an adjusted bundle problem, for the noise estimate. Internal to the bundle
// adjustment.

namespace cartvo::vo {

/// Magnitudes of the residuals, per pyramid level over all landmarks and for each landmark's last
/// observation.
class ResidualSizes {
 public:
  void reset(const BundleBlocks& blocks) {
    for (ByLevel* sizes : {&pixels_, &disparities_})
      for (SizeHistogram& of_level : *sizes)
        of_level.clear();
    last_.clear();
    last_.reserve(blocks.landmarks.capacity());
  }

  // Callbacks of ReducedSystem::build().
  void begin(const LandmarkBlock& block) {
    block_ = &block;
    last_.emplace_back();
  }

  void add(const BlockView& view, const ObservationRows& rows) {
    Last& last = last_.back();
    if (!view.isAnchor()) {
      const DoubleLanes& column = rows.row[ObservationRows::kColumn].residual;
      const DoubleLanes& row = rows.row[ObservationRows::kRow].residual;
      add(view.seen, column, pixels_);
      add(view.seen, row, pixels_);
      last.squares += view.seen * (column * column + row * row - last.squares);
      last.count += view.seen * (2.0 - last.count);
    }
    const DoubleLanes& disparity = rows.row[ObservationRows::kDisparity].residual;
    add(view.stereo, disparity, disparities_);
    last.squares += view.stereo * (disparity * disparity);
    last.count += view.stereo;
  }

  /// RMS residual of a landmark's last observation.
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
  static constexpr int kMinimumResiduals = 30;  ///< residuals from which the noise of a level is estimated

  struct Last {
    DoubleLanes squares{}, count{};
  };

  void add(const DoubleLanes& counts, const DoubleLanes& residual, ByLevel& sizes) const {
    for (int lane = 0; lane < kDoubleLanes; ++lane)
      if (counts[lane] > 0.0) sizes[block_->level[lane]].add(std::abs(residual[lane]));
  }

  /// Noise scale of a level. A level with too few residuals uses those of the level with the most.
  static double scaleOf(const ByLevel& sizes, int level) {
    const SizeHistogram* source = &sizes[level];
    if (source->count() < kMinimumResiduals)
      source = &*std::max_element(sizes.begin(), sizes.end(),
                                  [](const auto& a, const auto& b) { return a.count() < b.count(); });
    return source->count() == 0 ? 1.0 : source->stddev();
  }

  ByLevel pixels_, disparities_;
  std::vector<Last> last_;
  const LandmarkBlock* block_ = nullptr;  ///< current block
};

}  // namespace cartvo::vo
