// An alarm where the two cameras do not seem to look at the same things.
#include "daemon/match_watch.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace cartvo {
namespace {

constexpr int kPlenty = 100;  // corners
// Of the corners, fewer of which are found by chance and too few for a track. At dusk a sixteenth is found.
constexpr double kHardlyAny = 0.03;
constexpr int kFewest = 20;
constexpr std::int64_t kPatience = 5'000'000'000;  // ns

bool hardlyAny(const FeatureCounts& counts) {
  return counts.stereo < std::max<double>(kFewest, kHardlyAny * counts.detected);
}

/// Whether both images were looked at: not those of a pair that was refused or measured against a stand.
bool looked(OdometryReason reason) {
  return reason != OdometryReason::zero_velocity && reason != OdometryReason::offset_uncertain &&
         reason != OdometryReason::time_step;
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
  if (!since_ns_ || estimate.exposure_ns < *since_ns_) since_ns_ = estimate.exposure_ns;
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
