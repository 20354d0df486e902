#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <vector>

#include "capture/pair_synchroniser.hpp"

namespace cartvo::doctor {

/// How many pairs of this size are kept: at most 40, and at most 200 MB.
std::size_t keptPairCapacity(const capture::FramePair& pair);

/// The pair with pictures of its own, which no decoder shares.
capture::FramePair ownedPair(capture::FramePair pair);

/// Pairs the frames of two cameras and keeps the last pairs. Thread-safe.
class KeptPairs {
 public:
  /// `period_ns`: as PairSynchroniserSettings'.
  explicit KeptPairs(std::int64_t period_ns);

  /// Adds a frame, whose picture is copied.
  void add(capture::CameraSide side, const capture::Frame& frame);

  /// Removes and returns the kept pairs, see keptPairCapacity.
  std::vector<capture::FramePair> take();

 private:
  std::mutex mutex_;
  capture::PairSynchroniser synchroniser_;
  std::deque<capture::FramePair> pairs_;
};

}  // namespace cartvo::doctor
