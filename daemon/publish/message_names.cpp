// Names of values in messages: reasons, states, sources of instants.

#include "daemon/publish/message_names.hpp"

#include <array>
#include <cstddef>

#include "vo_core/odometry_reason.hpp"

namespace cartvo::daemon {

std::string reasonNames(std::int32_t reasons) {
  std::string names;
  for (const vo::OdometryReasonText& text : vo::kOdometryReasons)
    if ((reasons & static_cast<std::int32_t>(text.reason)) != 0)
      names += (names.empty() ? "" : ", ") + std::string(text.words);
  return names;
}

namespace {

template <std::size_t count>
const char* named(const std::array<const char*, count>& names, int value) {
  return value >= 0 && static_cast<std::size_t>(value) < count ? names[static_cast<std::size_t>(value)]
                                                               : "unknown";
}

}  // namespace

const char* cameraStateName(int state) {
  return named<6>({"connecting", "streaming", "stalled", "refused", "ended", "frozen"}, state);
}

const char* odometryStateName(int state) {
  return named<6>(
      {"tracking", "standstill", "left camera frozen", "right camera frozen", "both cameras frozen", "lost"},
      state);
}

const char* instantSourceName(int source) {
  return named<5>({"file", "sender reports", "arrival", "pictures", "kernel"}, source);
}

}  // namespace cartvo::daemon
