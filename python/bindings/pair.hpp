#pragma once

#include <cstdint>

#include <pybind11/pybind11.h>

#include "capture/pair_synchroniser.hpp"

namespace cartvo::python {

/// A pair as the Python class Pair holds it: of a recording, or of two numpy arrays, in whose memory its
/// images then lie.
struct Pair {
  capture::FramePair frames;
  pybind11::object left_array, right_array;  ///< owners of the images; empty for a pair of a recording

  /// Instants for the odometry, ns: time steps by the left camera's own clock, as corrections of the
  /// exposures are no motion.
  std::int64_t left_ns() const { return frames.left.exposure_ns - frames.left.slew_ns; }
  std::int64_t right_ns() const { return left_ns() + frames.offsetNs(); }
};

/// Throws ValueError if an instant is so far from zero that differences overflow.
void checkInstants(std::int64_t left_ns, std::int64_t right_ns);

/// Throws ValueError unless it is finite and not negative.
void checkOffsetStddev(double offset_stddev);

}  // namespace cartvo::python
