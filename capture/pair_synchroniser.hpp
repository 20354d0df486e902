#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "capture/camera_side.hpp"
#include "capture/frame.hpp"
#include "capture/frame_period.hpp"

namespace cartvo {

/// A left and a right frame that belong together.
struct FramePair {
  Frame left;
  Frame right;

  /// The instants do not continue those of the pair before: a camera's clock was set back, or related anew.
  bool time_restarted = false;

  /// Right minus left exposure, ns. The cameras run free, so it is rarely zero.
  std::int64_t offsetNs() const { return right.exposure_ns - left.exposure_ns; }

  /// Standard deviation of the offset, ns: the two cameras' clocks err independently.
  double offsetDeviationNs() const {
    return std::hypot(static_cast<double>(left.exposure_deviation_ns),
                      static_cast<double>(right.exposure_deviation_ns));
  }
};

struct PairSynchroniserSettings {
  /// Time between two frames of one camera, ns; 0: learned from the exposures. Pairs are at most half of it
  /// apart.
  std::int64_t period_ns = 0;

  /// Frames of one camera that may wait for the other's; beyond it the oldest goes.
  std::size_t queue_length = 16;

  /// A clock that was set back is followed after this many frames in a row that lie before the last one.
  int restart_after = 8;
};

/// What became of one camera's frames. `received` is the sum of the others and of the frames that wait.
struct PairingCounts {
  std::uint64_t received = 0;
  std::uint64_t paired = 0;
  std::uint64_t no_partner = 0;       ///< the other camera has no frame within half a period
  std::uint64_t damaged = 0;          ///< its picture cannot be trusted
  std::uint64_t out_of_order = 0;     ///< its instant is not after the one before
  std::uint64_t overflow = 0;         ///< waited too long for the other camera
  std::uint64_t clock_restarted = 0;  ///< waited when a camera's clock was set back
};

/// Pairs the frames of two free-running cameras by their exposure instants. Pure: no clock, no thread, and
/// the pairs depend only on the two sequences, not on how their arrivals interleave, as long as no queue
/// overflows (and the period is given: a learned one settles with the first frames).
///
/// The oldest left and right frames make a pair as soon as both are there and at most half a period apart. If
/// they are further apart, the older one can have no partner any more, because later frames of the other
/// camera lie further off still: it is dropped. Each frame is used at most once, pairs come in the order of
/// time, and damaged frames never make one.
class PairSynchroniser {
 public:
  /// Throws std::invalid_argument if a setting is negative or a queue could hold nothing.
  explicit PairSynchroniser(const PairSynchroniserSettings& settings);

  void push(CameraSide side, Frame frame);

  /// The next pair, or nothing until more frames are pushed. Call until it returns nothing.
  std::optional<FramePair> pop();

  /// No more frames will come from this camera: the other's need not wait for one.
  void finish(CameraSide side);

  const PairingCounts& counts(CameraSide side) const { return sides_[index(side)].counts; }

  /// The period that pairs are judged by, ns; 0 while it is not known, when only frames of one instant pair.
  std::int64_t periodNs() const;

 private:
  struct Side {
    std::deque<Frame> waiting;
    PairingCounts counts;
    FramePeriod period;
    std::optional<std::int64_t> last_ns;  ///< latest instant accepted
    std::int64_t last_backward_ns = 0;
    int backward_in_row = 0;
    bool finished = false;
  };

  static std::size_t index(CameraSide side) { return static_cast<std::size_t>(side); }
  bool accept(Side& side, const Frame& frame);
  void restart(Side& side, const Frame& frame);
  static void drop(Side& side, std::uint64_t PairingCounts::*reason);

  PairSynchroniserSettings settings_;
  std::array<Side, 2> sides_;
  bool time_restarted_ = false;
};

}  // namespace cartvo
