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
  std::vector<capture::FramePair> spread;       ///< over the whole time, 0.25 s or more apart
};

/// Keeps pairs: at most 40 consecutive ones in 150 MB, and 80 spread ones in 300 MB. If more would be spread,
/// every second one is dropped and their distance doubles.
class PairKeeper {
 public:
  void add(capture::FramePair pair);

  KeptPairs take();

 private:
  std::deque<capture::FramePair> consecutive_;
  std::vector<capture::FramePair> spread_;
  std::int64_t distance_ns_ = 250'000'000;  ///< least, between spread pairs
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
