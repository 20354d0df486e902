#pragma once

#include <cstddef>
#include <vector>

#include "tools/simulate/encode_content.hpp"
#include "tools/world/world_settings.hpp"

namespace cartvo::benchmark {

/// A feature's depth as it was measured and as it truly is, m, along the rectified camera's axis.
struct DepthSample {
  double measured = 0.0;
  double truth = 0.0;
};

/// How well measured depths follow the true ones.
struct DepthRegression {
  std::size_t samples = 0;
  double r_squared = 0.0;  ///< coefficient of determination of the line through them, by least squares
  double slope = 0.0;      ///< of that line, measured over true
};

/// There must be two samples of unlike depth.
DepthRegression regressDepth(const std::vector<DepthSample>& samples);

/// The depths of one and the same matches, from the disparity as matched and from its nearest whole pixel:
/// the corners matched stand on whole pixels, so that this is the sample whose surroundings the sub-pixel fit
/// looks at. Left out are features beyond `kFarthestDepth` and those whose true depth is not clear (at the
/// edges of things).
struct DepthSamples {
  std::size_t features = 0;  ///< with a clear true depth
  std::size_t wrong = 0;     ///< of these, matched more than two pixels off: in neither list
  std::vector<DepthSample> sub_pixel;
  std::vector<DepthSample> whole_pixel;  ///< fewer: a disparity of zero has no depth
};

constexpr double kFarthestDepth = 50.0;  ///< m

/// Of these, measured to within a tenth.
std::size_t closeDepths(const std::vector<DepthSample>& samples);

/// Detects and matches `features` in `pairs` pairs spread evenly over a rendered drive.
DepthSamples measureDepths(const world::WorldSettings& settings, int pairs, int features,
                           const simulate::Progress& progress);

}  // namespace cartvo::benchmark
