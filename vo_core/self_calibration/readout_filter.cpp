// Information filter for the readouts of rolling shutters.
#include "vo_core/self_calibration/readout_filter.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo::vo {
namespace {

constexpr double kPriorStddev = 0.0048;  // s, of a readout to be checked: 15 % of that of usual sensors
// Weight of an image: errors of consecutive ones are correlated because landmarks last about ten pairs.
constexpr double kImageWeight = 0.1;
// s, error of the estimate that does not average out: of the order that errors of depths and poses leave.
constexpr double kModelStddev = 8e-4;
constexpr double kLongestReadout = 0.1;  // s

}  // namespace

ReadoutFilter::ReadoutFilter(const Shutter& shutter)
    : known_(shutter.readout), is_known_(!(shutter.readout_stddev > 0.0)), estimate_(shutter.readout) {
  const double stddev = is_known_ ? kPriorStddev : shutter.readout_stddev;
  information_ = 1.0 / (stddev * stddev);
}

void ReadoutFilter::update(const ReadoutEquation& equation, double weight) {
  if (!std::isfinite(equation.information) || !std::isfinite(equation.gradient)) return;
  const double sum = information_ + kImageWeight * weight * equation.information;
  // The equation is about the readout in use, which differs from the estimate of a known one.
  const double gradient = equation.gradient - equation.information * (estimate_ - readout());
  information_ = sum;
  estimate_ =
      std::clamp(estimate_ + kImageWeight * weight * gradient / sum, -kLongestReadout, kLongestReadout);
}

EstimateWithStddev ReadoutFilter::estimate() const {
  return {estimate_, std::sqrt(1.0 / information_ + kModelStddev * kModelStddev)};
}

ReadoutFilters::ReadoutFilters(const StereoShutters& shutters)
    : left_(shutters.left),
      difference_({shutters.right.readout - shutters.left.readout, shutters.right.readout_stddev, {}}),
      known_right_(shutters.right.readout),
      is_right_known_(!(shutters.right.readout_stddev > 0.0)) {}

ReadoutEstimates ReadoutFilters::estimates() const {
  const EstimateWithStddev left = left_.estimate(), difference = difference_.estimate();
  return {left, {left.value + difference.value, std::hypot(left.stddev, difference.stddev)}};
}

}  // namespace cartvo::vo
