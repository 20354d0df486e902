#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>

#include <opencv2/core/types.hpp>

#include "capture/pair_synchroniser.hpp"

namespace cartvo {

/// Both sides' counts, summed.
struct PairingTotals {
  PairingCounts frames;
  std::uint64_t pairs = 0;
};
PairingTotals totals(const PairSynchroniser& synchroniser);

/// Where the two reader threads and the odometry's thread meet: frames come in, the newest pair goes out. A
/// pair that was not taken before the next one is made is skipped and counted, so that nothing ages in a
/// queue.
class LivePairing {
 public:
  LivePairing(const PairSynchroniserSettings& settings, cv::Size image_size);

  /// From a camera's thread. A frame whose size is not the rig's is refused and counted.
  void push(CameraSide side, Frame frame);

  /// The camera will deliver no more.
  void finish(CameraSide side);

  /// Waits for a pair until the deadline; nothing if none came, or at once when both cameras have finished.
  std::optional<FramePair> take(std::chrono::steady_clock::time_point deadline);

  bool finished() const;

  struct Counts {
    PairingTotals pairing;
    std::uint64_t skipped = 0;
    std::uint64_t refused_size = 0;
  };
  Counts counts() const;

  /// A sentence about a stream whose latest picture was refused; empty if there is none.
  std::string problem() const;

 private:
  bool bothFinished() const { return finished_[0] && finished_[1]; }

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  PairSynchroniser synchroniser_;
  cv::Size image_size_;
  std::optional<FramePair> newest_;
  std::array<bool, 2> finished_{};
  std::array<std::optional<cv::Size>, 2> refused_;  ///< size of each side's latest frame, if it was refused
  std::uint64_t skipped_ = 0;
  std::uint64_t refused_size_ = 0;
};

/// "left camera: the stream is 704x576, but the rig is for 680x420; ..."
std::string wrongSizeMessage(CameraSide side, cv::Size stream, cv::Size rig);

}  // namespace cartvo
