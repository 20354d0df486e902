// Detects missing stereo matches between the two cameras.
#include "daemon/diagnostics/stereo_match_monitor.hpp"

namespace cartvo::daemon {
namespace {

constexpr int kMinCorners = 100;
// Minimum fraction of the corners that are matched in the right image. Cameras with different views reach 1 %
// at most, by chance; an intact rig has 6 % at dusk, and far more by day.
constexpr double kMinMatchFraction = 0.03;
constexpr std::int64_t kMinDuration_ns = 5'000'000'000;
constexpr std::int64_t kMaxGap_ns = 1'000'000'000;  // pairs farther apart are not consecutive

bool hasTooFewMatches(const vo::FeatureCounts& counts) {
  return counts.stereo < kMinMatchFraction * counts.detected;
}

/// True if the pair's stereo matches were counted: false for a rejected pair and for a zero-velocity update.
bool isObservable(const vo::OdometryReasons& reasons) {
  return reasons != vo::OdometryReason::zero_velocity && reasons != vo::OdometryReason::offset_uncertain &&
         reasons != vo::OdometryReason::offset_too_large && reasons != vo::OdometryReason::repeated_picture &&
         reasons != vo::OdometryReason::time_step && reasons != vo::OdometryReason::wrong_stereo_geometry;
}

}  // namespace

void StereoMatchMonitor::update(const vo::OdometryEstimate& estimate) {
  if (!isObservable(estimate.reasons)) return;
  if (estimate.counts.detected < kMinCorners || !hasTooFewMatches(estimate.counts)) {
    since_ns_.reset();
    missing_ = false;
    return;
  }
  const std::int64_t gap_ns = estimate.exposure_ns - last_ns_;
  last_ns_ = estimate.exposure_ns;
  if (!since_ns_ || gap_ns < 0 || gap_ns > kMaxGap_ns) since_ns_ = estimate.exposure_ns;
  missing_ = estimate.exposure_ns - *since_ns_ >= kMinDuration_ns;
}

std::string StereoMatchMonitor::message() const {
  if (!missing_) return {};
  return "hardly any corner of the left picture is found in the right one: check for a turned, covered or "
         "defocused camera, swapped cameras, a wrong rig file, or a wall too near for both cameras";
}

}  // namespace cartvo::daemon
