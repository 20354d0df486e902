#pragma once

#include <optional>

#include "capture/camera_source.hpp"
#include "capture/pair_synchroniser.hpp"

// Pairs of two sources that end, such as recordings.

namespace cartvo::capture {

/// Reads two sources to their ends, merged in the order of recording or, where that is unknown, of exposure,
/// and pairs their frames. The same sources give the same pairs. Reads a frame of each source ahead. Not
/// thread-safe.
class PairReader {
 public:
  /// The sources must outlive the reader. Throws what PairSynchroniser throws.
  PairReader(CameraSource& left, CameraSource& right, const PairSynchroniserSettings& settings);

  /// The next pair; nothing after the last one. Throws what the sources throw.
  std::optional<FramePair> next();

  /// The synchroniser, for its counts.
  const PairSynchroniser& synchroniser() const { return synchroniser_; }

 private:
  /// A source that is read a frame ahead.
  struct LookAhead {
    CameraSource& source;
    std::optional<Frame> frame{};
    bool ended = false;

    void fill();
  };

  LookAhead left_, right_;
  PairSynchroniser synchroniser_;
};

}  // namespace cartvo::capture
