// Names of the bits of odometry_t.reasons.

#include "daemon/publish/odometry_reasons.hpp"

#include <array>
#include <utility>

#include <cartvo/odometry_t.hpp>

namespace cartvo::daemon {
std::string reasonNames(std::int32_t reasons) {
  static constexpr std::array<std::pair<std::int32_t, const char*>, 17> kNames{{
      {odometry_t::REASON_FIRST_PAIR, "first pair"},
      {odometry_t::REASON_TOO_FEW_FEATURES, "too few features"},
      {odometry_t::REASON_TOO_FEW_MATCHES, "too few matches"},
      {odometry_t::REASON_TOO_FEW_INLIERS, "too few inliers"},
      {odometry_t::REASON_HIGH_RESIDUAL, "high residual"},
      {odometry_t::REASON_TIME_STEP, "time step"},
      {odometry_t::REASON_IMPLAUSIBLE_MOTION, "implausible motion"},
      {odometry_t::REASON_DEGENERATE_GEOMETRY, "degenerate geometry"},
      {odometry_t::REASON_ZERO_VELOCITY, "zero velocity"},
      {odometry_t::REASON_OFFSET_UNCERTAIN, "offset uncertain"},
      {odometry_t::REASON_OFFSET_TOO_LARGE, "offset too large"},
      {odometry_t::REASON_REPEATED_PICTURE, "repeated picture"},
      {odometry_t::REASON_WRONG_STEREO_GEOMETRY, "wrong stereo geometry"},
      {odometry_t::REASON_BOUND, "bound above its alert limit"},
      {odometry_t::REASON_NO_PAIR, "no pair"},
      {odometry_t::REASON_DAMAGED_FRAME, "damaged frame"},
      {odometry_t::REASON_WRONG_SIZE, "wrong picture size"},
  }};
  std::string names;
  for (const auto& [bit, name] : kNames) {
    if ((reasons & bit) != 0) names += (names.empty() ? "" : ", ") + std::string(name);
  }
  return names;
}

}  // namespace cartvo::daemon
