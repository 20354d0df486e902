#pragma once

#include <cstdint>

#include "calib/model/rig.hpp"
#include "calib/rectification/rectification.hpp"
#include "capture/stereo_source.hpp"
#include "vo_core/shutter.hpp"

namespace cartvo::pipeline {

/// Readout of a camera whose rig does not state one.
enum class AbsentReadout : std::uint8_t {
  global_shutter,  ///< 0
  unknown,         ///< 32 ms with a standard deviation of 4.8 ms, for sensors of IP and USB cameras
};

/// `unknown` for recordings, which are of IP cameras; `global_shutter` for image folders and videos.
AbsentReadout absentReadoutOf(capture::SourceKind kind);

/// The shutters of a rig for its rectified images. The rig's readouts count as exact.
vo::StereoShutters stereoShutters(const calib::Rig& rig, const calib::Rectification& rectification,
                                  AbsentReadout absent);

}  // namespace cartvo::pipeline
