// Names of values in health messages.
#include "daemon/publish/camera_health_names.hpp"

#include <array>
#include <cstddef>

namespace cartvo::daemon {
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
