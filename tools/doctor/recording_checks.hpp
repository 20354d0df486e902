#pragma once

#include <atomic>
#include <filesystem>
#include <optional>

#include "calib/model/rig.hpp"
#include "capture/camera_side.hpp"
#include "daemon/service/configuration.hpp"
#include "pipeline/shutters.hpp"
#include "tools/cartvo/work_observer.hpp"
#include "tools/doctor/cameras/kept_pairs.hpp"
#include "tools/doctor/cameras/stream_measurement.hpp"
#include "tools/doctor/finding_list.hpp"

// Checks of a recording or sequence on disk.

namespace cartvo::doctor {

/// Checks the description of a recording and its completeness. The configuration that it contains, if any.
std::optional<daemon::Configuration> checkRecording(const std::filesystem::path& folder,
                                                    FindingList& findings);

/// Measures one camera's stream from the first `seconds` of a recording.
StreamMeasurement measureRecording(const std::filesystem::path& folder, capture::CameraSide side,
                                   double seconds, const std::atomic<bool>& interrupted);

/// Rig and pairs that are read of a source.
struct SourceContent {
  std::optional<calib::Rig> rig;
  KeptPairs pairs;  ///< of its first two minutes
  pipeline::AbsentReadout absent_readout = pipeline::AbsentReadout::unknown;
};

/// Opens a source, finds its rig and reads pairs; faults are findings. `progress`: in seconds of the source.
SourceContent readSource(const std::filesystem::path& folder, const WorkObserver::Progress& progress,
                         const std::atomic<bool>& interrupted, FindingList& findings);

}  // namespace cartvo::doctor
