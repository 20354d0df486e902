#pragma once

#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <vector>

#include "capture/pair_synchroniser.hpp"

namespace cartvo::doctor {

/// Pairs of two cameras, in order of time. Their pictures are their own: no decoder shares them.
struct KeptPairs {
  std::vector<capture::FramePair> consecutive;  ///< the last ones
  std::vector<capture::FramePair> spread;       ///< the first ones that are 0.25 s or more apart
};

/// Keeps pairs: of each kind at most 40, and at most 150 MB.
class PairKeeper {
 public:
  void add(capture::FramePair pair);

  /// Whether further pairs only replace consecutive ones.
  bool hasAllSpread() const { return has_all_spread_; }

  KeptPairs take();

 private:
  std::deque<capture::FramePair> consecutive_;
  std::vector<capture::FramePair> spread_;
  bool has_all_spread_ = false;
};

/// Pairs the frames of two live cameras and keeps pairs. Thread-safe.
class LivePairKeeper {
 public:
  LivePairKeeper() : synchroniser_({}) {}

  void add(capture::CameraSide side, const capture::Frame& frame);
  KeptPairs take();

 private:
  std::mutex mutex_;
  capture::PairSynchroniser synchroniser_;
  PairKeeper keeper_;
};

}  // namespace cartvo::doctor
