#pragma once

#include <atomic>
#include <chrono>
#include <optional>
#include <string>

#include <cartvo/health_t.hpp>

#include "tools/doctor/finding_list.hpp"

namespace cartvo::doctor {

/// Observation of the messages that LCM delivers on one URL.
struct LcmObservation {
  std::string problem;       ///< why LCM cannot be used; empty if it can
  bool is_returned = false;  ///< a message of this process was received back
  int odometry_messages = 0;
  bool has_foreign_messages = false;  ///< of another definition of the types
  bool has_two_publishers = false;    ///< the sequence numbers of two programs alternate
  std::optional<health_t> health;     ///< the last one
};

/// Sends a message on the channel CARTVO_DOCTOR and listens to odometry and health. Ends after `duration`, or
/// as soon as its own and a health message have come. LCM's own test of the route may take longer; it goes on
/// in a thread that is not waited for.
LcmObservation observeLcm(const std::string& url, std::chrono::milliseconds duration,
                          const std::atomic<bool>& interrupted);

/// Checks the route of the multicast group, and what was observed on the URL.
void checkLcm(const std::string& url, const LcmObservation& seen, FindingList& findings);

}  // namespace cartvo::doctor
