#pragma once

#include <array>
#include <optional>
#include <string>

#include "pipeline/frame_periods.hpp"
#include "pipeline/shutters.hpp"

namespace cartvo::daemon {

/// The problem of the cameras' frame rates, as measured: they differ from each other or from the configured
/// rate (Hz) by a tenth or more, by the exposures and by the arrivals: the former may be rounded, the latter
/// lack frames that were lost. Empty if there is none.
std::string frameRateProblem(const pipeline::FramePeriods& periods, std::optional<double> configured);

/// Readouts of the left and the right camera as the rig file or the configuration states them, s; empty if it
/// states none.
using StatedReadouts = std::array<std::optional<double>, 2>;

/// Compares the readouts estimated while driving with the stated ones and, unless both are stated, with each
/// other. A difference is reported while it is significant (3 standard deviations) and above 0.5 ms, until it
/// is clearly smaller. Two sensors whose readouts happen to have the ratio of the modes for 50 Hz and 60 Hz,
/// such as 32 and 27 ms, are reported as two settings of the line frequency: the readouts alone do not tell.
class ReadoutCheck {
 public:
  explicit ReadoutCheck(const StatedReadouts& stated) : stated_(stated) {}

  /// Returns whether the set of differences to report has changed.
  bool update(const vo::ReadoutEstimates& estimates);

  /// The difference with its numbers and what to do; empty if there is none.
  std::string message() const;

  const std::optional<vo::ReadoutEstimates>& latest() const { return latest_; }

 private:
  StatedReadouts stated_;
  std::optional<vo::ReadoutEstimates> latest_;
  std::array<bool, 3> faulty_{};  ///< left, right, both cameras against each other
};

}  // namespace cartvo::daemon
