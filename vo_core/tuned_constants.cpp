// The lists of the tuned constants and of the limits of the product.
#include "vo_core/tuned_constants.hpp"

#include <cmath>

namespace cartvo::vo {
namespace {

using Member = std::variant<int*, double*>;

#define CONSTANT(member, unit, low, high, source)                                              \
  {                                                                                            \
#member, unit, low, high, source, [](OdometrySettings & s) -> Member { return &s.member; } \
  }

constexpr TunedConstant kConstants[] = {
    CONSTANT(features, "", 50, 20000, "measured: half as many add 20 % of error, twice as many remove 5 %"),
    CONSTANT(detection.window_columns, "", 1, 100, "thesis 4.9"),
    CONSTANT(detection.window_rows, "", 1, 100, "thesis 4.9"),
    CONSTANT(detection.minimum_threshold, "grey", 1, 254, "thesis 4.9: below, corners are noise"),
    CONSTANT(detection.maximum_threshold, "grey", 1, 254, "thesis 4.9"),
    CONSTANT(detection.corners_per_feature, "", 1, 100, "a choice of two corners for each feature"),
    CONSTANT(detection.adaptation_exponent, "", 0.01, 1,
             "a fifth: the count falls with about the fifth power of the threshold"),
    CONSTANT(detection.trial_memory, "pairs", 1, 1e6, "assumption: ten seconds"),
    CONSTANT(detection.level_sharpness, "", 0.1, 100,
             "measured: nearly all to the better level (docs/architecture.md)"),
    CONSTANT(tracking.levels, "", 1, 8, "structural: reaches a tenth of the image"),
    CONSTANT(tracking.convergence, "px", 1e-4, 1, "a tenth of a pixel: below the noise of a patch"),
    CONSTANT(tracking.minimum_correlation, "", -1, 1, "thesis 4.13"),
    CONSTANT(tracking.maximum_backward_error, "px", 0, 100, "Kalal et al. 2010; measured"),
    CONSTANT(tracking.minimum_distance, "px", 1, 100, "half a patch"),
    CONSTANT(tracking.search_again, "pairs", 0, 7, "a quarter of a second at 18 Hz"),
    CONSTANT(tracking.minimum_shift_correlation, "", -1, 1, "above that of unrelated patches"),
    CONSTANT(tracking.maximum_stretch, "", 0.01, 0.6, "below what the alignment follows, 0.6"),
    CONSTANT(tracking.maximum_prediction_error, "px", 0.1, 100,
             "half of what the search near the prediction reaches"),
    CONSTANT(tracking.predicted_inverse_depth, "1/m", 0, 10, "a point 50 m away"),
    CONSTANT(tracking.minimum_patch_noise, "px", 0, 10,
             "fitted on rendered worlds and kitti_06 (docs/architecture.md)"),
    CONSTANT(tracking.minimum_codec_noise, "px", 0, 10,
             "fitted on rendered worlds and kitti_06 (docs/architecture.md)"),
    CONSTANT(stereo.minimum_disparity, "px", 0.01, 100, "two to three times its noise"),
    CONSTANT(stereo.rows, "px", 0, 3, "rectification errors of a pixel"),
    CONSTANT(stereo.minimum_correlation, "", -1, 1, "thesis 4.4"),
    CONSTANT(stereo.uniqueness, "", 0, 1, "Lowe's ratio test (2004)"),
    CONSTANT(stereo.maximum_sad_ratio, "", 1, 100, "assumption"),
    CONSTANT(history.half_weight_stddevs, "", 0.1, 100, "a robust scale of two standard deviations"),
    CONSTANT(history.minimum_weight, "", 0, 1, "assumption"),
    CONSTANT(pose_search.subsets, "", 0, 10000,
             "RANSAC: all inliers in one subset of four at 50 % outliers, with 98 %"),
    CONSTANT(pose_search.gate, "", 0.1, 100, "three standard deviations"),
    CONSTANT(pose_search.maximum_acceleration, "m/s^2, rad/s^2", 0.1, 1e6,
             "kerbs, measured on a golf cart's shocks"),
    CONSTANT(pose_search.minimum_share, "", 0, 1, "more than agree by chance"),
    CONSTANT(window.pairs, "pairs", 2, 7, "measured"),
    CONSTANT(uncertainty.drift_ratio, "", 0, 100,
             "fitted to the growth of pose errors on rendered drives (docs/architecture.md)"),
    CONSTANT(uncertainty.drift_correlation_pairs, "pairs", 1, 1e4,
             "fitted to the growth of pose errors on rendered drives (docs/architecture.md)"),
    CONSTANT(standstill.translation, "m", 0, 1, "measured on euroc_still"),
    CONSTANT(standstill.rotation, "rad", 0, 1, "measured on euroc_still"),
    CONSTANT(standstill.least_time, "s", 0, 3600, "shorter than any stop"),
    CONSTANT(standstill.motion_significance, "", 0.1, 100, "certain: five standard deviations"),
    CONSTANT(unknown_velocity, "m/s", 0.01, 1000, "a golf cart's usual speed"),
    CONSTANT(self_calibration.calibration_stddev, "rad", 1e-06, 1,
             "assumption: 0.2 degrees, by a mount or a bump"),
    CONSTANT(self_calibration.skew_stddev, "", 1e-06, 1, "KITTI's rectified images have 9e-3"),
    CONSTANT(self_calibration.delay_stddev, "s", 1e-06, 1, "timestamps of a network camera"),
    CONSTANT(self_calibration.readout_stddev, "s", 1e-06, 1,
             "of a measurement by a lamp; one that is 5 ms off is corrected"),
    CONSTANT(self_calibration.rotation_drift, "rad", 0, 1, "assumption: 0.1 mrad in 40 minutes"),
    CONSTANT(self_calibration.delay_drift, "s", 0, 1, "clocks that differ by 50 ppm"),
    CONSTANT(self_calibration.correlated_pairs, "pairs", 1, 1000, "the usual life of a landmark"),
    CONSTANT(self_calibration.rate_stddev, "rad/s", 1e-06, 10, "assumption"),
    CONSTANT(self_calibration.unknown_rate_stddev, "rad/s", 1e-06, 10, "3 m/s past a point 10 m away"),
    CONSTANT(self_calibration.yaw_pattern_stddev, "rad", 0, 1,
             "assumption: what lenses leave that resembles a yaw"),
    CONSTANT(self_calibration.uncorrected_yaw_share, "", 0, 100, "assumption"),
};

constexpr TunedConstant kLimits[] = {
    CONSTANT(self_calibration.maximum_rotation, "rad", 0, 1, "more needs a new calibration"),
    CONSTANT(validity.minimum_features, "", 3, 20000, "fewer show too little texture"),
    CONSTANT(validity.minimum_matches, "", 3, 20000, "fewer do not contradict a wrong motion"),
    CONSTANT(validity.minimum_inliers, "", 3, 20000, "the same"),
    CONSTANT(validity.minimum_inlier_ratio, "", 0, 1, "below, most of the scene moves otherwise"),
    CONSTANT(validity.maximum_time_step, "s", 0.001, 60, "a lost second does not end an epoch"),
    CONSTANT(validity.maximum_offset, "s", 0, 10, "beyond, the cart moves too far between the exposures"),
    CONSTANT(validity.maximum_offset_uncertainty, "s", 0, 10, "beyond, depths are unknown"),
    CONSTANT(validity.maximum_speed, "m/s", 0.1, 1000, "of any vehicle with this daemon"),
    CONSTANT(validity.maximum_rate, "rad/s", 0.01, 100, "the same"),
};

#undef CONSTANT

}  // namespace

double TunedConstant::value(const OdometrySettings& settings) const {
  OdometrySettings copy = settings;
  return std::visit([](const auto* number) { return static_cast<double>(*number); }, member(copy));
}

void TunedConstant::set(double value, OdometrySettings& settings) const {
  const Member number = member(settings);
  if (int* const* const integer = std::get_if<int*>(&number))
    **integer = static_cast<int>(std::lround(value));
  else
    *std::get<double*>(number) = value;
}

bool TunedConstant::isInteger() const {
  OdometrySettings settings;
  return std::holds_alternative<int*>(member(settings));
}

std::span<const TunedConstant> tunedConstants() {
  return kConstants;
}

std::span<const TunedConstant> productLimits() {
  return kLimits;
}

}  // namespace cartvo::vo
