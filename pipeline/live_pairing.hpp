#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

#include <opencv2/core/types.hpp>

#include "capture/pair_synchroniser.hpp"
#include "pipeline/frame_periods.hpp"

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
  void push(capture::CameraSide which, capture::Frame frame);

  /// Marks the end of a camera's frames.
  void finish(capture::CameraSide which);

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

  /// Measured frame periods of the left and the right camera.
  FramePeriods periods() const;

  /// Describes a stream whose latest frame was rejected for its size; empty if there is none.
  std::string problem() const;

  /// Why frames are paired seldom: they arrive in bursts, or none have been paired for seconds although both
  /// cameras deliver some; empty otherwise.
  std::string pairingProblem() const;

 private:
  /// One camera's frames.
  struct Side {
    std::optional<cv::Size> refused;     ///< size of the latest frame, if rejected
    std::deque<std::int64_t> arrivals;   ///< of the latest frames, ns
    std::int64_t exposure_ns = 0;        ///< of the latest frame
    capture::PairingCounts before_pair;  ///< at the latest pair
    bool finished = false;
  };

  const Side& side(capture::CameraSide which) const { return sides_[static_cast<std::size_t>(which)]; }
  bool bothFinished() const { return sides_[0].finished && sides_[1].finished; }

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  capture::PairSynchroniser synchroniser_;
  cv::Size image_size_;
  std::optional<capture::FramePair> newest_;
  std::array<Side, 2> sides_;
  std::optional<std::int64_t> last_pair_ns_;  ///< arrival of the latest pair, or of the first frame
  std::uint64_t skipped_ = 0;
  std::uint64_t refused_size_ = 0;
};

/// Error text: "left camera: the stream is 704x576, but the rig is for 680x420; ..."
std::string wrongSizeMessage(capture::CameraSide side, cv::Size stream, cv::Size rig);

}  // namespace cartvo::pipeline
