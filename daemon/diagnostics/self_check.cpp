// Self-check messages about the rig calibration, the time offset and missing stereo matches.

#include "daemon/diagnostics/self_check.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "common/units.hpp"

namespace cartvo::daemon {
namespace {

// s; smaller ones are not reported. Two clocks that follow one time server agree to this, so that less cannot
// be repaired; and in a turn of 0.5 rad/s it moves pictures of 500 px focal length by 0.25 px, about the
// noise of a match, and the scale by 1 %.
constexpr double kMinTimeOffset = 1e-3;
// rad; smaller ones are not reported: they change the path by less than a tenth even if yaw is not corrected.
constexpr double kMinAngle = 0.1 / kDegreesPerRadian;
constexpr double kMatchLossAngle = 0.15 / kDegreesPerRadian;  // rad; larger ones may prevent stereo matches
constexpr double kMinSignificance = 3.0;                      // standard deviations, of a reported fault
constexpr double kMinShownStddev = 0.01, kMinShownTimeStddev = 0.1;  // deg, ms
constexpr double kShareMemory = 0.05;                                // per pair, of shares of the last pairs
constexpr double kMinValidShare = 0.5;  // of pairs; below, their angles are not reported
constexpr double kHysteresis = 0.7;     // a reported fault ends below this fraction of its limit
// A vehicle ahead at the same speed keeps its place for seconds, too.
constexpr std::int64_t kMinStillTime_ns = 20'000'000'000;

/// Time offset, then the angles.
std::array<vo::EstimateWithStddev, 4> asArray(const vo::RigCalibrationError& rig) {
  return {rig.delay, rig.pitch, rig.yaw, rig.roll};
}
constexpr std::array<const char*, 4> kNames{"", "pitch", "yaw", "roll"};

std::string timeOffsetMessage(const vo::EstimateWithStddev& delay) {
  return fmt::format(
      "the right camera is exposed {:.1f} ± {:.1f} ms {} than its timestamps say: check both cameras' clocks",
      1e3 * std::abs(delay.value), std::max(kMinShownTimeStddev, 1e3 * delay.stddev),
      delay.value > 0.0 ? "later" : "earlier");
}

}  // namespace

void SelfCheck::update(const vo::OdometryEstimate& estimate) {
  const bool is_named =
      estimate.stereo_fault != vo::StereoFault::none && estimate.stereo_fault != vo::StereoFault::suspected;
  const vo::StereoFault reported = reportedFault();
  if (is_named || estimate.valid) stereo_fault_ = is_named ? estimate.stereo_fault : vo::StereoFault::none;
  changed_ = changed_ || reportedFault() != reported;
  if (estimate.rig) updateRig(*estimate.rig);
  if (estimate.readouts) changed_ = readouts_.update(*estimate.readouts) || changed_;
  const bool were_missing = areMatchesMissing();
  matches_.update(estimate);
  changed_ = changed_ || areMatchesMissing() != were_missing;
  updateStillRegions(estimate);
  const bool was_part = hidesPart();
  valid_share_ += kShareMemory * ((estimate.valid ? 1.0 : 0.0) - valid_share_);
  part_share_ += kShareMemory * ((estimate.part_stands ? 1.0 : 0.0) - part_share_);
  changed_ = changed_ || hidesPart() != was_part;
}

void SelfCheck::setTexture(bool suffices) {
  const vo::StereoFault reported = reportedFault();
  const bool were_missing = areMatchesMissing();
  texture_suffices_ = suffices;
  changed_ = changed_ || reportedFault() != reported || areMatchesMissing() != were_missing;
}

void SelfCheck::updateStillRegions(const vo::OdometryEstimate& estimate) {
  if (!estimate.valid) return;  // of some invalid pairs the regions are not known
  const bool were_shown = !still_regions_.empty();
  if (estimate.still_regions.empty())
    still_since_ns_.reset();
  else if (!still_since_ns_)
    still_since_ns_ = estimate.exposure_ns;
  const bool are_shown = still_since_ns_ && estimate.exposure_ns - *still_since_ns_ >= kMinStillTime_ns;
  still_regions_ = are_shown ? estimate.still_regions : vo::ImageRegions();
  changed_ = changed_ || are_shown != were_shown;
}

void SelfCheck::updateRig(const vo::RigCalibrationError& rig) {
  rig_ = rig;
  const auto list = asArray(rig);
  for (std::size_t i = 0; i < kQuantities; ++i) {
    const double size = std::abs(list[i].value);
    const double limit = i == 0 ? kMinTimeOffset : kMinAngle;
    const bool matters = size > (faulty_[i] ? kHysteresis : 1.0) * limit;
    // Also of a fault that was reported: an estimate that has faded, as at a standstill, says nothing.
    const bool is_faulty = matters && size > kMinSignificance * list[i].stddev;
    changed_ = changed_ || is_faulty != faulty_[i];
    faulty_[i] = is_faulty;
  }
}

std::string SelfCheck::stereoFaultMessage() const {
  for (const vo::StereoFaultText& text : vo::kStereoFaults)
    if (text.fault == reportedFault()) return text.sentence;
  // If an angle causes the missing matches, message() reports the angle. Otherwise only the missing matches:
  // an estimate from few matches is not worth its space in the message.
  if (areMatchesMissing() && !anglesCauseMissingMatches()) return matches_.message();
  if (!hidesPart()) return {};
  return "a part of the left picture stands still while the rest moves: if it is the cart or dirt on the "
         "lens, mask it (cartvo calibrate mask), turn the camera or clean it; vehicles around a standing "
         "cart pass";
}

std::string SelfCheck::message() const {
  if (std::string fault = stereoFaultMessage(); !fault.empty()) return fault;
  // Pictures that do not belong together give angles, too.
  const bool are_angles_known = valid_share_ > kMinValidShare || areMatchesMissing();
  const std::string angles = are_angles_known ? anglesMessage() : std::string();
  const std::string offset = faulty_[0] ? timeOffsetMessage(rig_->delay) : std::string();
  if (offset.empty() && angles.empty()) {
    const std::string readouts = readouts_.message();
    return readouts.empty() ? stillRegionsMessage() : readouts;
  }
  return offset + (offset.empty() || angles.empty() ? "" : "; ") + angles;
}

std::string SelfCheck::stillRegionsMessage() const {
  if (still_regions_.empty()) return {};
  const vo::ImageRegion& region = still_regions_.front();
  const std::string others =
      still_regions_.size() > 1 ? fmt::format(" and {} more", still_regions_.size() - 1) : std::string();
  return fmt::format(
      "the left picture stands still at x {} to {}, y {} to {} px{}, not used: lettering, dirt, or the cart "
      "itself; 'cartvo calibrate mask' masks it",
      region.x, region.x + region.width, region.y, region.y + region.height, others);
}

bool SelfCheck::anglesCauseMissingMatches() const {
  if (!rig_) return false;
  const auto list = asArray(*rig_);
  for (std::size_t i = 1; i < kQuantities; ++i)
    if (faulty_[i] && std::abs(list[i].value) > kMatchLossAngle) return true;
  return false;
}

std::string SelfCheck::anglesMessage() const {
  if (!rig_) return {};
  const auto list = asArray(*rig_);
  std::string angles;
  for (std::size_t i = 1; i < kQuantities; ++i)
    if (faulty_[i])
      angles += fmt::format("{}{:+.2f} ± {:.2f} deg in {}", angles.empty() ? "" : ", ",
                            kDegreesPerRadian * list[i].value,
                            std::max(kMinShownStddev, kDegreesPerRadian * list[i].stddev), kNames[i]);
  if (angles.empty()) return {};
  return "the right camera is turned by " + angles + " against the rig file: calibrate again";
}

bool SelfCheck::consumeChange() {
  const bool changed = changed_;
  changed_ = false;
  return changed;
}

}  // namespace cartvo::daemon
