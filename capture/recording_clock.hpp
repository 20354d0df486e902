#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <optional>

#include "capture/camera_side.hpp"
#include "capture/pair_clock.hpp"
#include "capture/recording_rows.hpp"

namespace cartvo {

/// Stamps a recording's pictures anew, by the clock model as live: from RTP times, sender reports and
/// arrivals, of both cameras in the order in which they came, whatever of the videos can be read. One thread.
class RecordingClock {
 public:
  RecordingClock(const std::filesystem::path& recording, ClockChoice choice);

  /// The instant of the picture with that `order`; nothing if the index does not know it. Each camera's
  /// pictures must be asked for in their order.
  std::optional<StampedInstant> stamp(CameraSide side, std::uint64_t order);

  /// As PairClock's.
  void setVisual(const std::optional<ClockWitness>& offset) { clock_.setVisual(offset); }
  ClockStatus status() const { return clock_.status(); }

 private:
  struct Stamped {
    std::uint64_t order = 0;
    StampedInstant instant;
  };
  struct Side {
    explicit Side(RecordedRows recorded) : rows(std::move(recorded)), next(rows.next()) {}

    RecordedRows rows;
    const IndexRow* next;
    std::uint64_t connection = 0;
    std::deque<Stamped> waiting;  ///< stamped, and not asked for yet
  };

  bool stampNext();

  PairClock clock_;
  std::array<Side, 2> sides_;
};

}  // namespace cartvo
