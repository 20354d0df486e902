#pragma once

#include <atomic>

#include <cartvo/health_t.hpp>

#include "daemon/diagnostics/measurement_checks.hpp"
#include "daemon/service/configuration.hpp"
#include "tools/doctor/finding_list.hpp"

// Checks of the state that a running cartvod reports.

namespace cartvo::doctor {

/// Checks the health message of a running cartvod except for its cameras' parts. `rig_readouts`: of the rig
/// file or the configuration, s.
void checkHealth(const health_t& health, const daemon::Configuration& configuration,
                 const daemon::StatedReadouts& rig_readouts, FindingList& findings);

/// Checks one camera's part of a health message: the stream as cartvod receives it.
void checkCameraHealth(const camera_health_t& camera, const daemon::Configuration& configuration,
                       FindingList& findings);

/// Asks /healthz, if the configuration has it served.
void checkHealthPage(const daemon::Configuration& configuration, const std::atomic<bool>& interrupted,
                     FindingList& findings);

}  // namespace cartvo::doctor
