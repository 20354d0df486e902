#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "capture/camera_side.hpp"
#include "capture/camera_source.hpp"
#include "capture/clock/frame_period_estimator.hpp"
#include "capture/frame.hpp"

// Pairing of the left and right frames of two unsynchronised cameras.
// Pairs of two sources that end, such as recordings.

namespace cartvo::capture {

/// A left and a right frame, at most half a period apart, or a little more (PairSynchroniser).
struct FramePair {
  Frame left;
  Frame right;

  /// Time offset: right minus left exposure, ns. Rarely zero, because the cameras are not synchronised.
  std::int64_t offsetNs() const { return right.exposure_ns - left.exposure_ns; }

  /// Standard deviation of the offset, ns; the errors of the two cameras' instants are independent.
  double offsetStddevNs() const;
};

struct PairSynchroniserSettings {
  /// Frame period of one camera, ns; 0: estimated from the exposures.
  std::int64_t period_ns = 0;

  /// Maximum number of one camera's frames that wait for the other's; the oldest is dropped beyond it.
  std::size_t queue_length = 16;

  /// Number of consecutive frames earlier than the last accepted one after which the clock counts as set
  /// back.
  int restart_after = 8;
};

/// Counts of one camera's frames. `received` is the sum of the others and of the frames that wait.
struct PairingCounts {
  std::uint64_t received = 0;
  std::uint64_t paired = 0;
  std::uint64_t no_partner = 0;       ///< dropped: the other camera has no frame within half a period
                                      ///< and the margin
  std::uint64_t damaged = 0;          ///< dropped: the picture is damaged
  std::uint64_t out_of_order = 0;     ///< dropped: the instant is not later than the previous one
  std::uint64_t overflow = 0;         ///< dropped: the queue was full
  std::uint64_t clock_restarted = 0;  ///< dropped: in the queue when the camera's clock was set back
};

/// Pairs the frames of two free-running cameras by their exposure instants. Uses no clock and no thread. The
/// pairs depend on the two sequences only, not on how their arrivals interleave, as long as no queue
/// overflows and the period is given (an estimated one settles with the first frames).
///
/// The oldest left and right frames form a pair if they are at most half a period apart. If they are further
/// apart, the older one is dropped, because later frames of the other camera are further away still. At an
/// offset near half a period, a frame's partner is kept until another frame is clearly nearer: a pair that
/// continues the offset of the last pair may be farther apart by a margin of three standard deviations of the
/// offset, at least an eighth and at most a quarter of a period. So jitter drops no frame. Each frame is used
/// at most once, pairs are in the order of time, and damaged frames are never paired.
class PairSynchroniser {
 public:
  /// Throws std::invalid_argument if the period is negative, the queue length 0 or restart_after below 1.
  explicit PairSynchroniser(const PairSynchroniserSettings& settings);

  void push(CameraSide side, Frame frame);

  /// Removes and returns the next pair; nothing until more frames are pushed. Call until it returns nothing.
  std::optional<FramePair> pop();

  /// Ends this camera's sequence: the other camera's frames no longer wait for it.
  void finish(CameraSide side);

  /// Measured frame period of one camera, ns; 0 until it is known.
  std::int64_t framePeriodNs(CameraSide side) const { return sides_[index(side)].period.periodNs(); }

  const PairingCounts& counts(CameraSide side) const { return sides_[index(side)].counts; }

  /// The frame period in use, ns; 0 while it is unknown: then only frames with equal instants are paired.
  std::int64_t periodNs() const;

 private:
  struct Side {
    std::deque<Frame> waiting;
    PairingCounts counts;
    FramePeriodEstimator period;
    std::optional<std::int64_t> last_ns;  ///< latest accepted instant
    std::int64_t last_backward_ns = 0;
    int backward_in_row = 0;
    bool finished = false;
  };

  static std::size_t index(CameraSide side) { return static_cast<std::size_t>(side); }
  bool accept(Side& side, const Frame& frame);
  void restart(Side& side, const Frame& frame);
  std::int64_t maximumOffsetNs(std::int64_t period) const;
  static void drop(Side& side, std::uint64_t PairingCounts::*reason);

  PairSynchroniserSettings settings_;
  std::array<Side, 2> sides_;
  std::optional<std::int64_t> last_offset_ns_;  ///< of the last pair; empty after a clock was set back
};

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
