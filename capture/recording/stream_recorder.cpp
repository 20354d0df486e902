// Recorder: queue between the cameras' threads and the writing thread, quota, stop and resume.

#include "capture/recording/stream_recorder.hpp"

#include <algorithm>
#include <array>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>
#include <variant>

#include "capture/recording/recording_writer.hpp"
#include "common/host_clock.hpp"

namespace cartvo::capture {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kSyncInterval{500};
constexpr int kMaxRetryIntervals = 64;  ///< longest pause between two attempts to resume, in quota intervals

/// Queue entry: a new connection's format or a picture.
struct Item {
  CameraSide side = CameraSide::left;
  std::variant<StreamFormat, EncodedUnit> content;

  std::size_t bytes() const {
    const EncodedUnit* unit = std::get_if<EncodedUnit>(&content);
    return unit != nullptr ? unit->data.size() : 0;
  }
};

}  // namespace

struct StreamRecorder::Implementation {
  /// Observer of one camera's stream; called in that camera's thread.
  class Side : public StreamObserver {
   public:
    Side(Implementation& recorder, CameraSide side) : recorder_(recorder), side_(side) {}

    void onStream(const StreamFormat& format) noexcept override { enqueue(format); }
    void onUnit(const EncodedUnit& unit) noexcept override { enqueue(unit); }

   private:
    template <typename Content>
    void enqueue(const Content& content) noexcept {
      try {
        recorder_.enqueue({side_, content});
      } catch (const std::exception& error) {
        recorder_.fail(error.what());
      }
    }

    Implementation& recorder_;
    CameraSide side_;
  };

  explicit Implementation(const RecordingSettings& recording)
      : settings(recording),
        writer(std::in_place, recording.folder,
               RecordingInfo{kRecordingFormatVersion, CARTVO_VERSION, wallClockNow(), recording.configuration,
                             recording.rig},
               recording.segment_length) {
    stopOnError([this] { requireQuota(); });
    thread = std::thread([this] { run(); });
  }

  void enqueue(Item item) {
    {
      const std::lock_guard lock(mutex);
      if (finishing) return;
      bool& is_in_gap = gap[static_cast<std::size_t>(item.side)];
      if (const EncodedUnit* unit = std::get_if<EncodedUnit>(&item.content)) {
        if (!accepting) {
          ++health.missing_pictures;
          return;
        }
        const bool has_room = waiting_bytes + unit->data.size() <= settings.queue_bytes;
        is_in_gap = !has_room || (is_in_gap && !unit->key);
        if (is_in_gap) {
          ++health.dropped_pictures;
          return;
        }
      }
      waiting_bytes += item.bytes();
      waiting.push_back(std::move(item));
    }
    changed.notify_one();
  }
  void run() noexcept {
    for (bool last = false; !last;) {
      for (std::deque<Item> items = waitForItems(last); !items.empty(); items.pop_front()) {
        const std::size_t bytes = items.front().bytes();
        stopOnError([&] { write(std::move(items.front())); });
        const std::lock_guard lock(mutex);
        waiting_bytes -= bytes;
      }
      stopOnError([&] { doPeriodicWork(last); });
    }
    writer.reset();
  }
  /// Waits for items, at most until the next sync is due. Sets `last` if no items will follow.
  std::deque<Item> waitForItems(bool& last) {
    std::unique_lock lock(mutex);
    changed.wait_until(lock, next_sync, [this] { return !waiting.empty() || finishing; });
    last = finishing;
    return std::exchange(waiting, {});
  }
  void write(Item item) {
    if (const StreamFormat* format = std::get_if<StreamFormat>(&item.content)) {
      writer->beginConnection(item.side, *format);
      return;
    }
    const std::size_t bytes = item.bytes();
    const bool is_written =
        !stopped && writer->write(item.side, std::move(std::get<EncodedUnit>(item.content)));
    unsynced = unsynced || is_written;
    const std::lock_guard lock(mutex);
    if (!is_written) {
      ++health.missing_pictures;
      return;
    }
    ++health.units;
    health.bytes += bytes;
  }
  /// Stops writing after a failure in a camera's thread; syncs and checks the quota when they are due.
  void doPeriodicWork(bool last) {
    if (!stopped && !isAccepting()) stopWriting();  // an error occurred in a camera's thread
    const Clock::time_point now = Clock::now();
    if (now >= next_sync || last) {
      next_sync = now + kSyncInterval;
      if (std::exchange(unsynced, false)) {
        writer->sync();
        clearError();
      }
    }
    if (now >= next_quota_check) {
      next_quota_check = now + settings.quota_interval;
      if (stopped)
        tryResume();
      else
        requireQuota();
    }
  }
  /// Throws std::runtime_error if the quota's free space cannot be reached.
  void requireQuota() {
    const QuotaOutcome outcome = applyQuota(settings.quota);
    if (!outcome.shortage.empty()) throw std::runtime_error(outcome.shortage);
  }
  /// Ends the segment. The pause before the next attempt grows with each failure, so that a failing disk is
  /// not filled with short segments.
  void stopWriting() noexcept {
    stopped = true;
    unsynced = false;
    writer->endSegment();
    next_quota_check = Clock::now() + retry_pause;
    retry_pause = std::min(2 * retry_pause, kMaxRetryIntervals * settings.quota_interval);
  }
  /// Accepts pictures again if there is enough free space.
  void tryResume() {
    RecordingQuota resume_quota = settings.quota;
    resume_quota.keep_free_bytes += settings.resume_margin_bytes;
    if (!applyQuota(resume_quota).shortage.empty()) return;
    stopped = false;
    const std::lock_guard lock(mutex);
    accepting = true;
  }
  /// Resets the error and the retry pause after a successful sync.
  void clearError() {
    retry_pause = settings.quota_interval;
    const std::lock_guard lock(mutex);
    if (!accepting || health.error.empty()) return;
    health.error.clear();
    ++health.resumptions;
  }
  /// Enforces a quota and counts the deleted bytes.
  QuotaOutcome applyQuota(const RecordingQuota& quota) {
    QuotaOutcome outcome = enforceQuota(quota, settings.folder, writer->oldestOpenSegment());
    const std::lock_guard lock(mutex);
    health.deleted_bytes += outcome.deleted_bytes;
    return outcome;
  }
  /// Stops accepting pictures. Called from any thread; keeps the first reason.
  void fail(const std::string& reason) noexcept {
    const std::lock_guard lock(mutex);
    if (accepting) health.error = "recording stopped: " + reason;
    accepting = false;
  }
  bool isAccepting() const {
    const std::lock_guard lock(mutex);
    return accepting;
  }
  void finish() {
    {
      const std::lock_guard lock(mutex);
      finishing = true;
    }
    changed.notify_one();
    if (thread.joinable()) thread.join();
  }

  /// Runs `work`. An exception stops the recording, not the thread.
  template <typename Work>
  void stopOnError(const Work& work) noexcept {
    try {
      work();
    } catch (const std::exception& error) {
      fail(error.what());
      stopWriting();
    }
  }

  RecordingSettings settings;
  Side left{*this, CameraSide::left};
  Side right{*this, CameraSide::right};

  // Used by the writing thread only, once it runs.
  std::optional<RecordingWriter> writer;
  Clock::time_point next_sync = Clock::now() + kSyncInterval;
  Clock::time_point next_quota_check = Clock::now() + settings.quota_interval;
  std::chrono::milliseconds retry_pause = settings.quota_interval;  ///< before the next attempt to resume
  bool unsynced = false;
  bool stopped = false;

  mutable std::mutex mutex;  ///< guards the members below
  std::condition_variable changed;
  std::deque<Item> waiting;
  std::size_t waiting_bytes = 0;
  std::array<bool, 2> gap{};  ///< the side's pictures are dropped up to its next key picture
  bool accepting = true;      ///< false after a failure, until the writing thread resumes
  bool finishing = false;
  RecorderHealth health;

  std::thread thread;
};

StreamRecorder::StreamRecorder(const RecordingSettings& settings)
    : implementation_(std::make_unique<Implementation>(settings)) {}

StreamRecorder::~StreamRecorder() {
  finish();
}

StreamObserver& StreamRecorder::left() {
  return implementation_->left;
}
StreamObserver& StreamRecorder::right() {
  return implementation_->right;
}

RecorderHealth StreamRecorder::health() const {
  const std::lock_guard lock(implementation_->mutex);
  return implementation_->health;
}

void StreamRecorder::finish() {
  implementation_->finish();
}

}  // namespace cartvo::capture
