#pragma once

#include <cmath>
#include <vector>

#include "vo_core/bundle_residuals.hpp"
#include "vo_core/median.hpp"

// Not for use outside the bundle adjustment.

namespace cartvo {

/// How large the residuals are, of all landmarks and of each one's last sighting.
class ResidualSizes {
 public:
  void reset(const BundleBlocks& blocks) {
    pixels_.clear();
    disparities_.clear();
    last_.clear();
    pixels_.reserve(2 * kDoubleLanes * blocks.sightings.capacity());
    disparities_.reserve(kDoubleLanes * blocks.sightings.capacity());
    last_.reserve(blocks.landmarks.capacity());
  }

  // Visits of ReducedSystem::build().
  void begin() { last_.emplace_back(); }

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

  void conclude(BundleResult& result) {
    result.pixel_scale = scaleOf(pixels_);
    result.disparity_scale = scaleOf(disparities_);
  }

 private:
  struct Last {
    DoubleLanes squares{}, count{};
  };

  static void add(const DoubleLanes& counts, const DoubleLanes& residual, std::vector<double>& sizes) {
    for (int lane = 0; lane < kDoubleLanes; ++lane)
      if (counts[lane] > 0.0) sizes.push_back(std::abs(residual[lane]));
  }

  static double scaleOf(std::vector<double>& sizes) { return sizes.empty() ? 1.0 : deviationOf(sizes); }

  std::vector<double> pixels_, disparities_;
  std::vector<Last> last_;
};

}  // namespace cartvo
