// An alarm where the two cameras do not seem to look at the same things.
#include "daemon/match_watch.hpp"

#include <fmt/format.h>

namespace cartvo {
namespace {

constexpr int kPlenty = 100;  // corners
// Share of the corners that are found in the right image. Of cameras that see different things it is 1 % at
// most, by chance; of a rig in order 6 % at dusk, and far more by day.
constexpr double kHardlyAny = 0.03;
constexpr std::int64_t kPatience = 5'000'000'000;    // ns
constexpr std::int64_t kLongestGap = 1'000'000'000;  // ns; pairs farther apart are not in a row

bool hardlyAny(const FeatureCounts& counts) {
  return counts.stereo < kHardlyAny * counts.detected;
}

/// Whether both images were looked at: not those of a pair that was refused or measured against a stand.
bool looked(const OdometryReasons& reasons) {
  return reasons != OdometryReason::zero_velocity && reasons != OdometryReason::offset_uncertain &&
         reasons != OdometryReason::repeated_picture && reasons != OdometryReason::time_step;
}

}  // namespace

void MatchWatch::note(const OdometryEstimate& estimate) {
  if (!looked(estimate.reasons)) return;
  counts_ = estimate.counts;
  if (counts_.detected < kPlenty || !hardlyAny(counts_)) {
    since_ns_.reset();
    missing_ = false;
    return;
  }
  const std::int64_t gap_ns = estimate.exposure_ns - last_ns_;
  last_ns_ = estimate.exposure_ns;
  if (!since_ns_ || gap_ns < 0 || gap_ns > kLongestGap) since_ns_ = estimate.exposure_ns;
  missing_ = estimate.exposure_ns - *since_ns_ >= kPatience;
}

std::string MatchWatch::sentence() const {
  if (!missing_) return {};
  return fmt::format(
      "hardly any of the left picture's corners ({} of {}) is found in the right one: is a camera turned, "
      "covered or out of focus, are the two swapped, is the rig file another rig's?",
      counts_.stereo, counts_.detected);
}

}  // namespace cartvo
