#pragma once

#include <cstddef>
#include <vector>

#include "lab/render/world_settings.hpp"
#include "tools/simulate/stream/encode_content.hpp"

namespace cartvo::benchmark {

/// The measured and the true depth of a feature along the axis of the rectified camera, m.
struct DepthSample {
  double measured = 0.0;
  double truth = 0.0;
};

/// The least-squares line of measured over true depth.
struct DepthRegression {
  std::size_t samples = 0;
  double r_squared = 0.0;  ///< coefficient of determination
  double slope = 0.0;      ///< measured over true depth
};

/// Requires two samples of different depth.
DepthRegression regressDepth(const std::vector<DepthSample>& samples);

/// Depths of the same matches from the sub-pixel disparity and from the nearest whole pixel. Matched corners
/// lie on whole pixels, so the whole-pixel disparity is the sample at the centre of the sub-pixel fit.
/// Features beyond `kMaxDepth` and features with an ambiguous true depth (at depth edges) are left out.
struct DepthSamples {
  std::size_t features = 0;  ///< features with an unambiguous true depth
  std::size_t wrong = 0;     ///< of these, matched more than two pixels off; in neither list
  std::vector<DepthSample> sub_pixel;
  std::vector<DepthSample> whole_pixel;  ///< without disparities that round to zero
};

constexpr double kMaxDepth = 50.0;  ///< m

/// The number of samples measured to within 10 % of the true depth.
std::size_t closeDepths(const std::vector<DepthSample>& samples);

/// Detects and matches `features` features in each of `pairs` pairs, evenly spaced over a rendered drive.
DepthSamples measureDepths(const world::WorldSettings& settings, int pairs, int features,
                           const simulate::Progress& progress);

}  // namespace cartvo::benchmark
