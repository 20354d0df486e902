// Names of the bits of odometry_t.reasons.

#include "daemon/publish/odometry_reasons.hpp"

#include "vo_core/odometry_reason.hpp"

namespace cartvo::daemon {

std::string reasonNames(std::int32_t reasons) {
  std::string names;
  for (const vo::OdometryReasonText& text : vo::kOdometryReasons)
    if ((reasons & static_cast<std::int32_t>(text.reason)) != 0)
      names += (names.empty() ? "" : ", ") + std::string(text.words);
  return names;
}

}  // namespace cartvo::daemon
