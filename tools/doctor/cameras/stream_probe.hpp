#pragma once

#include <array>
#include <atomic>

#include <opencv2/core/types.hpp>

#include "daemon/service/configuration.hpp"
#include "tools/cartvo/work_observer.hpp"
#include "tools/doctor/cameras/kept_pairs.hpp"
#include "tools/doctor/cameras/stream_measurement.hpp"

namespace cartvo::doctor {

/// Which streams are opened, and for how long they are measured.
struct ProbeSettings {
  std::array<bool, 2> cameras{true, true};  ///< left, right
  double seconds = 10.0;                    ///< s, from the first picture of each camera
  cv::Size size;                            ///< px, of the rig; empty: unknown
};

/// Streams and pairs that were received of both cameras.
struct Probe {
  std::array<StreamMeasurement, 2> streams;  ///< left, right
  KeptPairs pairs;
};

/// Receives both cameras' streams at the same time, each once, as cartvod does. A camera that gives no
/// picture within the configured time-outs is given up. `progress`: seconds that all cameras were measured.
/// Ends within about a second once `interrupted` is true.
Probe probeStreams(const daemon::Configuration& configuration, const ProbeSettings& settings,
                   const WorkObserver::Progress& progress, const std::atomic<bool>& interrupted);

}  // namespace cartvo::doctor
