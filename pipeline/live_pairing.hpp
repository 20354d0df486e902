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

// Hand-over of frame pairs from the reader threads to the odometry thread.

namespace cartvo::pipeline {

/// Counts of both cameras, summed.
struct PairingTotals {
  capture::PairingCounts frames;
  std::uint64_t pairs = 0;
};
PairingTotals totals(const capture::PairSynchroniser& synchroniser);

/// Passes frames from the two reader threads to the odometry's thread as pairs. Keeps only the newest pair:
/// one that was not fetched before the next one is formed is skipped and counted, so that no queue adds
/// latency. Thread-safe.
class LivePairing {
 public:
  LivePairing(const capture::PairSynchroniserSettings& settings, cv::Size image_size);

  /// Adds a frame of one camera. A frame whose size is not the rig's is rejected and counted.
  void push(capture::CameraSide side, capture::Frame frame);

  /// Marks the end of a camera's frames.
  void finish(capture::CameraSide side);

  /// Waits for a pair until the deadline. Returns nothing if none arrived, and returns at once when both
  /// cameras have finished.
  std::optional<capture::FramePair> waitForPair(std::chrono::steady_clock::time_point deadline);

  bool finished() const;

  struct Counts {
    PairingTotals pairing;
    std::uint64_t skipped = 0;
    std::uint64_t refused_size = 0;
  };
  Counts counts() const;

  /// Measured frame periods of the left and the right camera, ns; 0 until they are known.
  std::array<std::int64_t, 2> periodsNs() const;

  /// Describes a stream whose latest frame was rejected for its size; empty if there is none.
  std::string problem() const;

 private:
  bool bothFinished() const { return finished_[0] && finished_[1]; }

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  capture::PairSynchroniser synchroniser_;
  cv::Size image_size_;
  std::optional<capture::FramePair> newest_;
  std::array<bool, 2> finished_{};
  std::array<std::optional<cv::Size>, 2> refused_;  ///< size of each side's latest frame, if rejected
  std::uint64_t skipped_ = 0;
  std::uint64_t refused_size_ = 0;
};

/// Error text: "left camera: the stream is 704x576, but the rig is for 680x420; ..."
std::string wrongSizeMessage(capture::CameraSide side, cv::Size stream, cv::Size rig);

}  // namespace cartvo::pipeline
