// Alarms that a user can act on.

#include "daemon/self_check.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace cartvo {
namespace {

constexpr double kDegreesPerRadian = 180.0 / 3.14159265358979323846;
constexpr double kTellingDelay = 1e-3;                     // s
constexpr double kTellingAngle = 0.1 / kDegreesPerRadian;  // rad
constexpr double kHidingAngle = 0.15 / kDegreesPerRadian;  // rad, that may hide matches from the search
constexpr double kBeyondDoubt = 3.0;                       // standard deviations
constexpr double kFinest = 0.01;                           // deg that a sentence tells: nothing is exact
constexpr double kStillWrong = 0.7;                        // of what is telling, once it was told

/// In the order in which they are told: the delay, then the angles.
std::array<Checked, 4> listOf(const RigCheck& rig) {
  return {rig.delay, rig.pitch, rig.yaw, rig.roll};
}
constexpr std::array<const char*, 4> kNames{"", "pitch", "yaw", "roll"};

std::string delaySentence(const Checked& delay) {
  return fmt::format(
      "the right camera is exposed {:.1f} ± {:.1f} ms {} than its stamps say: check both cameras' clocks",
      1e3 * std::abs(delay.value), 1e3 * delay.deviation, delay.value > 0.0 ? "later" : "earlier");
}

}  // namespace

void SelfCheck::note(const OdometryEstimate& estimate) {
  if (estimate.rig) noteRig(*estimate.rig);
  const bool were_missing = matches_.missing();
  matches_.note(estimate);
  changed_ = changed_ || matches_.missing() != were_missing;
}

void SelfCheck::noteRig(const RigCheck& rig) {
  rig_ = rig;
  const auto list = listOf(rig);
  for (std::size_t i = 0; i < kTold; ++i) {
    const double size = std::abs(list[i].value);
    const double telling = i == 0 ? kTellingDelay : kTellingAngle;
    const bool appears = size > telling && size > kBeyondDoubt * list[i].deviation;
    const bool is_wrong = wrong_[i] ? size > kStillWrong * telling : appears;
    changed_ = changed_ || is_wrong != wrong_[i];
    wrong_[i] = is_wrong;
  }
}

std::string SelfCheck::sentence() const {
  // By how much a camera is turned says more than that matches are missing, if that is why they are. If not,
  // they come first, and by themselves: what few matches tell is worth less than the room it takes.
  if (matches_.missing() && !hidesMatches()) return matches_.sentence();
  const std::string turned = anglesSentence();
  const std::string late = wrong_[0] ? delaySentence(rig_->delay) : std::string();
  return late + (late.empty() || turned.empty() ? "" : "; ") + turned;
}

bool SelfCheck::hidesMatches() const {
  if (!rig_) return false;
  const auto list = listOf(*rig_);
  for (std::size_t i = 1; i < kTold; ++i)
    if (wrong_[i] && std::abs(list[i].value) > kHidingAngle) return true;
  return false;
}

std::string SelfCheck::anglesSentence() const {
  if (!rig_) return {};
  const auto list = listOf(*rig_);
  std::string angles;
  for (std::size_t i = 1; i < kTold; ++i)
    if (wrong_[i])
      angles += fmt::format("{}{:+.2f} ± {:.2f} deg in {}", angles.empty() ? "" : ", ",
                            kDegreesPerRadian * list[i].value,
                            std::max(kFinest, kDegreesPerRadian * list[i].deviation), kNames[i]);
  if (angles.empty()) return {};
  return "the right camera is turned by " + angles + " against the rig file: calibrate anew";
}

bool SelfCheck::takeChange() {
  const bool changed = changed_;
  changed_ = false;
  return changed;
}

}  // namespace cartvo
