#include "capture/stream_recorder.hpp"

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

#include "capture/recording_writer.hpp"

namespace cartvo {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kSyncInterval{500};
constexpr int kLongestPause = 64;  ///< intervals of the quota, between two attempts to begin again

/// What a camera's thread hands over.
struct Item {
  CameraSide side = CameraSide::left;
  std::variant<StreamFormat, EncodedUnit> content;

  std::size_t bytes() const {
    const EncodedUnit* unit = std::get_if<EncodedUnit>(&content);
    return unit != nullptr ? unit->data.size() : 0;
  }
};

std::int64_t nowNs() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace

struct StreamRecorder::Implementation {
  /// What one camera's thread calls.
  class Side : public StreamObserver {
   public:
    Side(Implementation& recorder, CameraSide side) : recorder_(recorder), side_(side) {}

    void onStream(const StreamFormat& format) noexcept override { handOver(format); }
    void onUnit(const EncodedUnit& unit) noexcept override { handOver(unit); }

   private:
    template <typename Content>
    void handOver(const Content& content) noexcept {
      try {
        recorder_.handOver({side_, content});
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
               RecordingInfo{kRecordingFormatVersion, CARTVO_VERSION, nowNs(), recording.configuration,
                             recording.rig},
               recording.segment_length) {
    guarded([this] { enforce(); });
    thread = std::thread([this] { run(); });
  }

  void handOver(Item item);
  void run() noexcept;
  std::deque<Item> takeWaiting(bool& last);
  void write(Item item);
  void keepUp(bool last);
  void enforce();
  void stopWriting() noexcept;
  void tryAgain();
  void goesOn();
  QuotaOutcome look(const RecordingQuota& quota);
  void fail(const std::string& reason) noexcept;
  bool accepts() const {
    const std::lock_guard lock(mutex);
    return accepting;
  }
  void finish();

  /// What goes wrong stops the recording, not the thread.
  template <typename Work>
  void guarded(const Work& work) noexcept {
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

  // The writing thread's own, once it runs.
  std::optional<RecordingWriter> writer;
  Clock::time_point next_sync = Clock::now() + kSyncInterval;
  Clock::time_point next_look = Clock::now() + settings.quota_interval;  ///< at the quota
  std::chrono::milliseconds pause = settings.quota_interval;             ///< after the next failure
  bool unsynced = false;
  bool stopped = false;

  mutable std::mutex mutex;  ///< guards what follows
  std::condition_variable changed;
  std::deque<Item> waiting;
  std::size_t waiting_bytes = 0;
  std::array<bool, 2> gap{};  ///< the side's pictures are left out up to its next key picture
  bool accepting = true;      ///< pictures; the writing thread has the last word, by `stopped`
  bool finishing = false;
  RecorderHealth health;

  std::thread thread;
};

void StreamRecorder::Implementation::handOver(Item item) {
  {
    const std::lock_guard lock(mutex);
    if (finishing) return;
    bool& in_gap = gap[static_cast<std::size_t>(item.side)];
    if (const EncodedUnit* unit = std::get_if<EncodedUnit>(&item.content)) {
      if (!accepting) return;
      const bool room = waiting_bytes + unit->data.size() <= settings.queue_bytes;
      in_gap = !room || (in_gap && !unit->key);
      if (in_gap) {
        ++health.left_out;
        return;
      }
    }
    waiting_bytes += item.bytes();
    waiting.push_back(std::move(item));
  }
  changed.notify_one();
}

/// Waits for something to do until the next sync is due. `last`: nothing more will come.
std::deque<Item> StreamRecorder::Implementation::takeWaiting(bool& last) {
  std::unique_lock lock(mutex);
  changed.wait_until(lock, next_sync, [this] { return !waiting.empty() || finishing; });
  last = finishing;
  return std::exchange(waiting, {});
}

void StreamRecorder::Implementation::run() noexcept {
  for (bool last = false; !last;) {
    for (std::deque<Item> items = takeWaiting(last); !items.empty(); items.pop_front()) {
      const std::size_t bytes = items.front().bytes();
      guarded([&] { write(std::move(items.front())); });
      const std::lock_guard lock(mutex);
      waiting_bytes -= bytes;
    }
    guarded([&] { keepUp(last); });
  }
  writer.reset();
}

void StreamRecorder::Implementation::write(Item item) {
  if (const StreamFormat* format = std::get_if<StreamFormat>(&item.content)) {
    writer->begin(item.side, *format);
    return;
  }
  const std::size_t bytes = item.bytes();
  if (stopped || !writer->write(item.side, std::move(std::get<EncodedUnit>(item.content)))) return;
  unsynced = true;
  const std::lock_guard lock(mutex);
  ++health.units;
  health.bytes += bytes;
}

/// What is due by the clock.
void StreamRecorder::Implementation::keepUp(bool last) {
  if (!stopped && !accepts()) stopWriting();  // a camera's thread failed
  const Clock::time_point now = Clock::now();
  if (now >= next_sync || last) {
    next_sync = now + kSyncInterval;
    if (std::exchange(unsynced, false)) {
      writer->sync();
      goesOn();
    }
  }
  if (now >= next_look) {
    next_look = now + settings.quota_interval;
    if (stopped)
      tryAgain();
    else
      enforce();
  }
}

void StreamRecorder::Implementation::enforce() {
  const QuotaOutcome outcome = look(settings.quota);
  if (!outcome.short_of_room.empty()) throw std::runtime_error(outcome.short_of_room);
}

QuotaOutcome StreamRecorder::Implementation::look(const RecordingQuota& quota) {
  QuotaOutcome outcome = enforceQuota(quota, settings.folder, writer->oldestOpenSegment());
  const std::lock_guard lock(mutex);
  health.deleted_bytes += outcome.deleted_bytes;
  return outcome;
}

/// The pauses grow while each attempt fails, so that a broken disk is not filled with beginnings.
void StreamRecorder::Implementation::stopWriting() noexcept {
  stopped = true;
  unsynced = false;
  writer->endSegment();
  next_look = Clock::now() + pause;
  pause = std::min(2 * pause, kLongestPause * settings.quota_interval);
}

void StreamRecorder::Implementation::tryAgain() {
  RecordingQuota with_room = settings.quota;
  with_room.keep_free_bytes += settings.room_to_begin_again;
  if (!look(with_room).short_of_room.empty()) return;
  stopped = false;
  const std::lock_guard lock(mutex);
  accepting = true;
}

/// Pictures have reached the disk.
void StreamRecorder::Implementation::goesOn() {
  pause = settings.quota_interval;
  const std::lock_guard lock(mutex);
  if (!accepting || health.error.empty()) return;
  health.error.clear();
  ++health.resumptions;
}

/// From any thread. The first reason counts.
void StreamRecorder::Implementation::fail(const std::string& reason) noexcept {
  const std::lock_guard lock(mutex);
  if (accepting) health.error = "recording stopped: " + reason;
  accepting = false;
}

void StreamRecorder::Implementation::finish() {
  {
    const std::lock_guard lock(mutex);
    finishing = true;
  }
  changed.notify_one();
  if (thread.joinable()) thread.join();
}

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

}  // namespace cartvo
