#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <cartvo/health_t.hpp>

#include "capture/camera_side.hpp"
#include "common/threads/handover_queue.hpp"
#include "common/threads/mailbox.hpp"
#include "daemon/page/health_json.hpp"
#include "daemon/page/page_sample.hpp"
#include "pipeline/pair_view.hpp"

namespace cartvo::daemon {

/// A pair for the page.
struct PageSnapshot {
  pipeline::PairView view;
  std::int64_t sequence = 0;  ///< of the pair's message
};

/// Newest picture and age of one camera, whether or not the other one delivers.
struct CameraView {
  cv::Mat picture;   ///< a copy of a raw picture; empty: no newer one
  double age = 0.0;  ///< of the newest frame, s; NaN: none since the start
};

/// The health message and what it does not say.
struct PageHealth {
  health_t health{};
  RecordingState recording;
  std::string stalled;
};

/// Hands what the odometry's and the cameras' threads know to the page's thread. None of them waits.
class LiveHandover final : public pipeline::PairViewer {
 public:
  using Clock = std::chrono::steady_clock;

  // Called by the odometry's thread.

  /// Wants ten pairs a second while there are viewers.
  pipeline::PairView* nextView() override { return nextViewAt(Clock::now()); }
  pipeline::PairView* nextViewAt(Clock::time_point now);
  /// `sample`: of the pair that nextView() was called for last.
  void addPair(const PageSample& sample);
  void addMissedPair(const PageSample& sample) { samples_.push(sample); }
  void setHealth(PageHealth health) { health_.put(std::make_unique<PageHealth>(std::move(health))); }

  // Called by the thread that reads this camera.

  /// Copies five pictures a second while there are viewers.
  void addFrame(capture::CameraSide side, const cv::Mat& picture, Clock::time_point now);

  // Called by the page's thread.

  std::optional<PageSample> nextSample() { return samples_.pop(); }
  std::unique_ptr<PageSnapshot> takeSnapshot() { return snapshots_.take(); }
  /// Gives back a snapshot for its memory.
  void recycle(std::unique_ptr<PageSnapshot> snapshot) { used_.put(std::move(snapshot)); }
  std::unique_ptr<PageHealth> takeHealth() { return health_.take(); }
  CameraView takeCamera(capture::CameraSide side, Clock::time_point now);

  // Called by the server's threads.

  void noteViewer() { last_viewer_ns_ = Clock::now().time_since_epoch().count(); }

  /// Whether a viewer has asked in the last two seconds. May be called by any thread.
  bool hasViewer(Clock::time_point now) const;

 private:
  static constexpr std::size_t kQueuedSamples = 1024;

  HandoverQueue<PageSample, kQueuedSamples> samples_;
  Mailbox<PageSnapshot> snapshots_, used_;
  Mailbox<PageHealth> health_;
  struct Camera {
    Mailbox<cv::Mat> picture;
    std::atomic<std::int64_t> last_ns{0};  ///< instant of the newest frame; 0: none
    Clock::time_point next_picture{};      ///< of the thread that reads the camera
  };
  std::array<Camera, 2> cameras_;  ///< left and right
  std::atomic<std::int64_t> last_viewer_ns_{0};
  // Of the odometry's thread:
  std::unique_ptr<PageSnapshot> filling_;
  bool is_filled_ = false;  ///< by the current pair
  Clock::time_point next_view_{};
};

}  // namespace cartvo::daemon
