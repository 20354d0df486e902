#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>

#include <cartvo/health_t.hpp>
#include <cartvo/odometry_t.hpp>

#include "capture/camera_side.hpp"
#include "common/threads/handover_queue.hpp"
#include "daemon/page/health_json.hpp"
#include "daemon/page/page_frame.hpp"
#include "daemon/page/page_history.hpp"
#include "daemon/page/page_server.hpp"
#include "pipeline/pair_processor.hpp"
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

/// Functions of the page's recording buttons. May be empty. Called by the page's threads.
struct RecordingControl {
  std::function<std::string()> start;  ///< returns why it was not started; empty: it was
  std::function<std::string()> stop;
};

/// JSON of PageContent::about(). `mode`: "live" or "replay". `title`: the rig's name or the replay's source.
std::string aboutJson(const std::string& mode, const std::string& title);

/// The status page of a running daemon. The odometry's thread never waits for it: numbers go through a queue
/// without locks, and pictures, only while a browser asks for them and ten times a second, through a mailbox.
/// A thread of low priority encodes each picture once for all viewers.
class StatusPage final : public PageContent {
 public:
  /// Throws what PageServer throws.
  StatusPage(const PageServerSettings& settings, const std::string& title, RecordingControl recording);

  std::string url() const { return server_.url(); }

  // Called by the odometry's thread.

  pipeline::PairViewer& viewer() { return handover_; }
  void addPair(const pipeline::PairResult& result, const odometry_t& message);
  void addMissedPair(const odometry_t& message);
  /// As PipelineProgress::stalledReader().
  void setStalled(const std::string& stalled) { stalled_ = stalled; }
  void setHealth(const health_t& health, const RecordingState& recording) {
    handover_.setHealth({health, recording, stalled_});
  }

  // Called by the threads that read the cameras.

  void addFrame(capture::CameraSide side, const capture::Frame& frame) {
    handover_.addFrame(side, frame.image, Clock::now());
  }

  std::string about() override { return about_; }
  std::optional<std::string> newestFrame(std::uint64_t seen) override;
  std::optional<std::string> storedFrame(std::uint64_t /*pair*/) override { return std::nullopt; }
  std::string history() override;
  std::string health() override;
  std::string control(const std::string& action) override;

 private:
  using Clock = std::chrono::steady_clock;

  void run(const std::stop_token& end);
  bool addSamples();
  void updateHealth();
  void addPictures();
  void renderFrame();

  LiveHandover handover_;
  std::string stalled_;  ///< of the odometry's thread
  std::string about_;
  RecordingControl recording_;
  std::mutex mutex_;  ///< for the following; only threads of low priority lock it
  std::condition_variable_any wake_;
  PageHistory history_;
  DaemonState state_;
  RecordingState recording_state_;
  Clock::time_point last_pair_;             ///< when the pictures of a pair came
  std::array<cv::Mat, 2> camera_pictures_;  ///< raw, left and right, the last ones
  std::array<double, 2> frame_ages_{};      ///< s; NaN: no frame yet
  EncodedPictures pictures_;
  std::string pictures_json_ = "null";
  std::uint64_t picture_number_ = 0;
  std::string frame_;
  std::uint64_t frame_number_ = 0;  ///< 0: none yet

  std::jthread thread_;  ///< ends before the others are destroyed
  PageServer server_;    ///< last, because its threads use the others
};

}  // namespace cartvo::daemon
