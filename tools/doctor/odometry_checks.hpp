#pragma once

#include <atomic>
#include <vector>

#include "calib/model/rig.hpp"
#include "capture/pair_synchroniser.hpp"
#include "pipeline/protection_level.hpp"
#include "pipeline/shutters.hpp"
#include "tools/cartvo/work_observer.hpp"
#include "tools/doctor/finding_list.hpp"
#include "vo_core/odometry_settings.hpp"

namespace cartvo::doctor {

/// Rig and settings with which the odometry computes.
struct OdometrySetup {
  calib::Rig rig;
  vo::OdometrySettings settings;
  int threads = 2;
  pipeline::AbsentReadout absent_readout = pipeline::AbsentReadout::unknown;
  pipeline::AlertLimits alert_limits{};
};

/// Processes consecutive pairs as cartvod does, and compares the time that takes with the frame period; also
/// checks whether the motion is valid at the end. `progress`: in pairs.
void checkProcessing(const std::vector<capture::FramePair>& pairs, const OdometrySetup& setup,
                     const WorkObserver::Progress& progress, const std::atomic<bool>& interrupted,
                     FindingList& findings);

}  // namespace cartvo::doctor
