#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include <cartvo/health_t.hpp>
#include <cartvo/odometry_t.hpp>

#include "daemon/page/health_json.hpp"
#include "daemon/page/live_handover.hpp"
#include "daemon/page/page_content.hpp"
#include "daemon/page/page_frame.hpp"
#include "daemon/page/page_history.hpp"
#include "daemon/page/page_server.hpp"
#include "pipeline/pair_processor.hpp"

namespace cartvo::daemon {

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
