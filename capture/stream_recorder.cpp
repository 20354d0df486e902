#include "capture/stream_recorder.hpp"

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
constexpr std::chrono::seconds kQuotaInterval{10};

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
        recorder_.stop(error.what());
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
    enforce();
    thread = std::thread([this] { run(); });
  }

  void handOver(Item item);
  void run() noexcept;
  std::deque<Item> takeWaiting(bool& last);
  void write(Item item);
  void enforce();
  void stop(const std::string& reason) noexcept;
  void finish();

  RecordingSettings settings;
  Side left{*this, CameraSide::left};
  Side right{*this, CameraSide::right};

  // The writing thread's own, once it runs.
  std::optional<RecordingWriter> writer;
  Clock::time_point next_sync = Clock::now() + kSyncInterval;
  Clock::time_point next_quota = Clock::now() + kQuotaInterval;
  bool unsynced = false;

  mutable std::mutex mutex;  ///< guards what follows
  std::condition_variable changed;
  std::deque<Item> waiting;
  std::size_t waiting_bytes = 0;
  std::array<bool, 2> gap{};  ///< the side's pictures are left out up to its next key picture
  bool finishing = false;
  RecorderHealth health;

  std::thread thread;
};

void StreamRecorder::Implementation::handOver(Item item) {
  {
    const std::lock_guard lock(mutex);
    if (finishing || !health.error.empty()) return;
    bool& in_gap = gap[static_cast<std::size_t>(item.side)];
    if (const EncodedUnit* unit = std::get_if<EncodedUnit>(&item.content)) {
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
  try {
    for (bool last = false; !last;) {
      for (std::deque<Item> items = takeWaiting(last); !items.empty(); items.pop_front()) {
        const std::size_t bytes = items.front().bytes();
        write(std::move(items.front()));
        const std::lock_guard lock(mutex);
        waiting_bytes -= bytes;
      }
      const Clock::time_point now = Clock::now();
      if (now >= next_sync || last) {
        if (std::exchange(unsynced, false)) writer->sync();
        next_sync = Clock::now() + kSyncInterval;
      }
      if (now >= next_quota) {
        enforce();
        next_quota = Clock::now() + kQuotaInterval;
      }
    }
  } catch (const std::exception& error) {
    stop(error.what());
  }
  writer.reset();
}

void StreamRecorder::Implementation::write(Item item) {
  if (const StreamFormat* format = std::get_if<StreamFormat>(&item.content)) {
    writer->begin(item.side, *format);
    return;
  }
  const std::size_t bytes = item.bytes();
  if (!writer->write(item.side, std::move(std::get<EncodedUnit>(item.content)))) return;
  unsynced = true;
  const std::lock_guard lock(mutex);
  ++health.units;
  health.bytes += bytes;
}

void StreamRecorder::Implementation::enforce() {
  const QuotaOutcome outcome = enforceQuota(settings.quota, settings.folder, writer->oldestOpenSegment());
  if (!outcome.short_of_room.empty()) throw std::runtime_error(outcome.short_of_room);
  const std::lock_guard lock(mutex);
  health.deleted_bytes += outcome.deleted_bytes;
}

/// The first reason counts.
void StreamRecorder::Implementation::stop(const std::string& reason) noexcept {
  const std::lock_guard lock(mutex);
  if (health.error.empty()) health.error = "recording stopped: " + reason;
  waiting.clear();
  waiting_bytes = 0;
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
