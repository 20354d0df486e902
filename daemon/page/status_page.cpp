// Live status page: the thread that turns pairs into frames, and the answers to the server's threads.
#include "daemon/page/status_page.hpp"

#include <condition_variable>
#include <limits>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "common/host_clock.hpp"
#include "common/threads/thread_priority.hpp"
#include "daemon/page/live_handover.hpp"
#include "daemon/page/page_frame.hpp"
#include "daemon/page/page_history.hpp"
#include "daemon/publish/odometry_reasons.hpp"

namespace cartvo::daemon {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kWatchedPeriod{40}, kUnwatchedPeriod{250};
constexpr std::size_t kNewestSamples = 32;  // in each frame: 0.5 s of 60 Hz

std::string sampleNames() {
  std::string json = "[";
  for (const char* name : kSampleFields)
    json += fmt::format("{}\"{}\"", json.size() > 1 ? "," : "", name);
  return json + "]";
}

}  // namespace

std::string aboutJson(const std::string& mode, const std::string& title) {
  return fmt::format(R"({{"mode":"{}","start":{},"version":"{}","title":{},"sample":{}}})", mode,
                     wallClockNow() / 1000, CARTVO_VERSION, jsonText(title), sampleNames());
}

class StatusPage::Implementation final : public PageContent {
 public:
  Implementation(const PageServerSettings& settings, const std::string& title, RecordingControl recording)
      : about_(aboutJson("live", title)), recording_(std::move(recording)), server_(settings, *this) {
    {
      const std::lock_guard lock(mutex_);  // the server answers already
      state_.last_message = Clock::now();
      state_.last_valid = state_.last_message - std::chrono::hours(1);
    }
    thread_ = std::jthread([this](const std::stop_token& end) { run(end); });
  }

  std::string url() const { return server_.url(); }

  std::string about() override { return about_; }
  std::optional<std::string> newestFrame(std::uint64_t seen) override;
  std::optional<std::string> storedFrame(std::uint64_t /*pair*/) override { return std::nullopt; }
  std::string history() override;
  std::string health() override;
  std::string control(const std::string& action) override;

  LiveHandover handover;
  std::string stalled;  ///< of the odometry's thread

 private:
  void run(const std::stop_token& end);
  bool addSamples();
  void updateHealth();
  void addSnapshot();
  void renderFrame();

  std::string about_;
  RecordingControl recording_;
  std::mutex mutex_;  ///< for the following; only threads of low priority lock it
  std::condition_variable_any wake_;
  PageHistory history_;
  DaemonState state_;
  RecordingState recording_state_;
  EncodedPictures pictures_;
  std::string pictures_json_ = "null";
  std::string frame_;
  std::uint64_t frame_number_ = 0;  ///< 0: none yet

  std::jthread thread_;  ///< ends before the others are destroyed
  PageServer server_;    ///< last, because its threads use the others
};

void StatusPage::Implementation::run(const std::stop_token& end) {
  lowerThreadPriority();
  std::unique_lock lock(mutex_);
  while (!end.stop_requested()) {
    const bool has_samples = addSamples();
    updateHealth();
    const bool is_watched = handover.hasViewer(Clock::now());
    if (is_watched && has_samples) {
      lock.unlock();
      addSnapshot();
      lock.lock();
      renderFrame();
    }
    wake_.wait_for(lock, end, is_watched ? kWatchedPeriod : kUnwatchedPeriod, [] { return false; });
  }
}

bool StatusPage::Implementation::addSamples() {
  bool has_samples = false;
  while (const std::optional<PageSample> sample = handover.nextSample()) {
    history_.add(*sample);
    state_.last_message = Clock::now();
    state_.reasons = sample->reasons();
    if (sample->isValid()) state_.last_valid = state_.last_message;
    has_samples = true;
  }
  return has_samples;
}

void StatusPage::Implementation::updateHealth() {
  const std::unique_ptr<PageHealth> newest = handover.takeHealth();
  if (!newest) return;
  state_.health = newest->health;
  state_.stalled = newest->stalled;
  recording_state_ = newest->recording;
}

/// Encodes the newest pictures. Without the lock: only this thread writes what it writes.
void StatusPage::Implementation::addSnapshot() {
  std::unique_ptr<PageSnapshot> snapshot = handover.takeSnapshot();
  if (!snapshot) return;
  pictures_ = encodePictures(snapshot->view);
  pictures_json_ = picturesJson(pictures_, snapshot->view, snapshot->sequence);
  handover.recycle(std::move(snapshot));
}

void StatusPage::Implementation::renderFrame() {
  const PageSample& newest = history_.newest();
  const std::string json =
      fmt::format(R"({{"number":{},"samples":{},"reasons":{},"pictures":{}}})", ++frame_number_,
                  history_.newestJson(kNewestSamples),
                  jsonText(newest.isValid() ? "" : reasonNames(newest.reasons())), pictures_json_);
  frame_ = frameBytes(json, pictures_.jpeg);
}

std::optional<std::string> StatusPage::Implementation::newestFrame(std::uint64_t seen) {
  handover.noteViewer();
  const std::lock_guard lock(mutex_);
  if (frame_number_ == 0 || frame_number_ == seen) return std::nullopt;
  return frame_;
}

std::string StatusPage::Implementation::history() {
  const std::lock_guard lock(mutex_);
  return history_.json();
}

std::string StatusPage::Implementation::health() {
  const std::lock_guard lock(mutex_);
  return fmt::format("{{{},{},{}}}", healthMembers(state_.health),
                     answerMembers(healthAnswer(state_, Clock::now())), recordingMembers(recording_state_));
}

std::string StatusPage::Implementation::control(const std::string& action) {
  if (action == "recording/start" && recording_.start) return recording_.start();
  if (action == "recording/stop" && recording_.stop) return recording_.stop();
  return "there is nothing to do this with";
}

StatusPage::StatusPage(const PageServerSettings& settings, const std::string& title,
                       RecordingControl recording)
    : implementation_(std::make_unique<Implementation>(settings, title, std::move(recording))) {}
StatusPage::~StatusPage() = default;

std::string StatusPage::url() const {
  return implementation_->url();
}
pipeline::PairViewer& StatusPage::viewer() {
  return implementation_->handover;
}
void StatusPage::addPair(const pipeline::PairResult& result, const odometry_t& message) {
  implementation_->handover.addPair(pageSample(message, result.times.total));
}
void StatusPage::addMissedPair(const odometry_t& message) {
  implementation_->handover.addMissedPair(pageSample(message, std::numeric_limits<double>::quiet_NaN()));
}
void StatusPage::setStalled(const std::string& stalled) {
  implementation_->stalled = stalled;
}
void StatusPage::setHealth(const health_t& health, const RecordingState& recording) {
  implementation_->handover.setHealth({health, recording, implementation_->stalled});
}

}  // namespace cartvo::daemon
