#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/rig.hpp"
#include "tools/camera/camera_access.hpp"
#include "tools/cartvo/work_observer.hpp"
#include "tools/doctor/finding.hpp"
#include "tools/doctor/picture_pair.hpp"

// All checks of `cartvo doctor`, one after the other.

namespace cartvo::doctor {

struct DoctorSettings {
  /// A configuration of cartvod, or the folder of a recording or sequence.
  std::filesystem::path source = "/etc/cartvo/cartvod.yaml";
  double seconds = 10.0;                 ///< s, duration for which streams are measured
  bool streams = false;                  ///< also while cartvod receives them
  AccessOptions access;                  ///< of the cameras' web pages; side and configuration do not count
  std::filesystem::path proc = "/proc";  ///< folder of the kernel's files
};

/// Receives what happens, in the calling thread.
struct DoctorObserver {
  std::function<void(const Findings&)> area;  ///< the findings of one area
  WorkObserver work;                          ///< what takes some seconds
};

/// All findings, and what the report shows of the cameras.
struct Examination {
  Findings findings;
  std::vector<PicturePair> pictures;  ///< in order of time; empty: there are none
  std::optional<calib::Rig> rig;      ///< nothing: it cannot be used
};

/// Looks at everything. Changes nothing; faults are findings. Ends early within about a second once
/// `interrupted` is true.
Examination examine(const DoctorSettings& settings, const DoctorObserver& observer,
                    const std::atomic<bool>& interrupted);

}  // namespace cartvo::doctor
