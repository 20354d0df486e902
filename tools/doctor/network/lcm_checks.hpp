#pragma once

#include <string>

#include "tools/doctor/finding_list.hpp"
#include "tools/doctor/network/lcm_observation.hpp"

namespace cartvo::doctor {

/// Checks the route of the multicast group, and what was observed on the URL.
void checkLcm(const std::string& url, const LcmObservation& seen, FindingList& findings);

}  // namespace cartvo::doctor
