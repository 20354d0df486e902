// Counts the INVALID pairs that the light of each camera explains.
#include "daemon/diagnostics/light_monitor.hpp"

#include <cstddef>
#include <cstdint>

#include <fmt/format.h>

namespace cartvo::daemon {

using pipeline::LightFault;

void LightMonitor::add(const pipeline::PairResult& result, const odometry_t& message) {
  if (result.light) light_ = *result.light;
  ++pairs_;
  if (message.status == odometry_t::VALID) return;
  for (std::size_t i = 0; i < light_.size(); ++i)
    if (pipeline::mayExplain(light_[i], static_cast<std::uint32_t>(message.reasons))) ++unlit_[i];
  if ((message.reasons & odometry_t::REASON_TOO_FEW_FEATURES) != 0) ++featureless_;
}

bool LightMonitor::hasTexture() const {
  return !pipeline::lacksTexture(light_[0]) && !pipeline::lacksTexture(light_[1]);
}

std::string LightMonitor::consumeProblem() {
  std::array<LightFault, 2> faults{};
  for (std::size_t i = 0; i < light_.size(); ++i)
    if (2 * unlit_[i] > pairs_) faults[i] = pipeline::lightFault(light_[i]);
  // Features are sought in the left picture. One that is out of focus has light and shade, but no corners.
  if (faults == std::array<LightFault, 2>{} && 2 * featureless_ > pairs_) faults[0] = LightFault::blank;
  pairs_ = featureless_ = 0;
  unlit_ = {};
  const LightFault fault = faults[0] != LightFault::none ? faults[0] : faults[1];
  if (fault == LightFault::none) return {};
  const char* const one = faults[0] == LightFault::none ? "right camera" : "left camera";
  return fmt::format("{}: {}: {}", faults[0] == faults[1] ? "both cameras" : one,
                     pipeline::lightFaultText(fault), pipeline::lightAdvice(fault));
}

}  // namespace cartvo::daemon
