#pragma once

#include <array>
#include <optional>

#include <opencv2/core/types.hpp>

#include "tools/doctor/cameras/stream_measurement.hpp"
#include "tools/doctor/finding_list.hpp"

// Judges measured streams.

namespace cartvo::doctor {

/// Required properties of a stream.
struct StreamNeeds {
  cv::Size size;                     ///< px, of the rig; empty: any
  std::optional<double> frame_rate;  ///< Hz, as configured; nothing: any
};

/// Checks one camera's stream. False if there is no picture.
bool checkStream(const StreamMeasurement& measurement, const StreamNeeds& needs, FindingList& findings);

/// Compares the streams of both cameras: rates, and clocks by the sender reports.
void compareStreams(const std::array<StreamMeasurement, 2>& streams, FindingList& findings);

}  // namespace cartvo::doctor
