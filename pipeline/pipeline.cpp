// The pipeline from two cameras to the sink: replay reads every frame and processes every pair; live runs the
// cameras on their own threads and processes only the newest pair.

#include "pipeline/pipeline.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "capture/pair_synchroniser.hpp"
#include "common/host_clock.hpp"
#include "pipeline/feature_budget.hpp"
#include "pipeline/live_pairing.hpp"
#include "pipeline/visual_offset_estimator.hpp"

namespace cartvo::pipeline {
namespace {

using SteadyClock = std::chrono::steady_clock;

/// Time that a reader waits for a frame before it loops.
constexpr std::chrono::milliseconds kReadTimeout{200};

/// Time between two messages while the cameras' frame rate is unknown, and its limits.
constexpr std::chrono::nanoseconds kFirstPeriod = std::chrono::milliseconds(55);
constexpr std::chrono::nanoseconds kShortestPeriod = std::chrono::milliseconds(4);
constexpr std::chrono::nanoseconds kLongestPeriod = std::chrono::milliseconds(500);

capture::PairSynchroniserSettings synchroniserSettings(std::int64_t period_ns) {
  capture::PairSynchroniserSettings settings;
  settings.period_ns = period_ns;
  return settings;
}

/// Time of a loop's last iteration; written by its thread, read by any thread.
class Heartbeat {
 public:
  void beat() { last_ns_ = SteadyClock::now().time_since_epoch().count(); }
  void stop() { stopped_ = true; }

  /// Time since the last beat, s; 0 after `stop`.
  double age() const {
    if (stopped_) return 0.0;
    const SteadyClock::duration since =
        SteadyClock::now().time_since_epoch() - SteadyClock::duration(last_ns_.load());
    return std::chrono::duration<double>(since).count();
  }

 private:
  std::atomic<SteadyClock::rep> last_ns_{SteadyClock::now().time_since_epoch().count()};
  std::atomic<bool> stopped_ = false;
};

void addPairing(const PairingTotals& totals, PipelineCounts& counts) {
  counts.pairs = totals.pairs;
  counts.dropped_no_partner = totals.frames.no_partner;
  counts.dropped_damaged = totals.frames.damaged;
  counts.dropped_out_of_order = totals.frames.out_of_order;
  counts.dropped_overflow = totals.frames.overflow;
  counts.dropped_clock = totals.frames.clock_restarted;
}

/// Reason for a missing pair, from the counts that increased meanwhile.
NoPairCause cause(const LivePairing::Counts& before, const LivePairing::Counts& now) {
  if (now.refused_size > before.refused_size) return NoPairCause::wrong_size;
  if (now.pairing.frames.damaged > before.pairing.frames.damaged) return NoPairCause::damaged;
  if (now.pairing.frames.no_partner > before.pairing.frames.no_partner) return NoPairCause::no_partner;
  return NoPairCause::no_frames;
}

}  // namespace

class Pipeline::Implementation {
 public:
  Implementation(capture::CameraSource& left, capture::CameraSource& right, PairProcessor& processor,
                 const PipelineSettings& settings)
      : left_(left),
        right_(right),
        processor_(processor),
        settings_(settings),
        live_(synchroniserSettings(settings.period_ns), settings.image_size) {}

  void replay(const PipelineSink& sink) {
    capture::PairReader reader(left_, right_, synchroniserSettings(settings_.period_ns));
    while (!stopped_) {
      const std::optional<capture::FramePair> pair = reader.next();
      if (!pair) break;
      requireRigSize(capture::CameraSide::left, pair->left);
      requireRigSize(capture::CameraSide::right, pair->right);
      processPair(*pair, sink);
    }
    const std::lock_guard lock(mutex_);
    replayed_ = totals(reader.synchroniser());
  }
  void runLive(const PipelineSink& sink) {
    {
      const std::jthread left_reader([this] { readCamera(left_, capture::CameraSide::left, left_beat_); });
      const std::jthread right_reader(
          [this] { readCamera(right_, capture::CameraSide::right, right_beat_); });
      try {
        processNewestPairs(sink);
      } catch (...) {
        stop();
        throw;
      }
      stop();
    }
    const std::lock_guard lock(mutex_);
    if (reader_failure_) std::rethrow_exception(reader_failure_);
  }
  void stop() noexcept {
    stopped_ = true;
    left_.interrupt();
    right_.interrupt();
  }
  PipelineCounts counts() const {
    PipelineCounts counts;
    const LivePairing::Counts live = live_.counts();
    const std::lock_guard lock(mutex_);
    addPairing(replayed_ ? *replayed_ : live.pairing, counts);
    counts.processed = processed_;
    counts.skipped = live.skipped;
    counts.refused_size = live.refused_size;
    counts.periods = live_.periods();
    return counts;
  }
  std::string problem() const { return live_.problem(); }
  std::string pairingProblem() const { return live_.pairingProblem(); }
  PipelineProgress progress() const { return {left_beat_.age(), right_beat_.age()}; }

 private:
  void readCamera(capture::CameraSource& source, capture::CameraSide side, Heartbeat& heartbeat) noexcept {
    try {
      capture::ReadOutcome outcome = capture::ReadOutcome::timed_out;
      while (!stopped_ && outcome != capture::ReadOutcome::ended) {
        heartbeat.beat();
        capture::Frame frame;
        outcome = source.read(frame, kReadTimeout);
        if (outcome != capture::ReadOutcome::frame) continue;
        if (settings_.frame) settings_.frame(side, frame);
        live_.push(side, std::move(frame));
      }
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!reader_failure_) reader_failure_ = std::current_exception();
      stop();
    }
    heartbeat.stop();
    live_.finish(side);
  }
  void processNewestPairs(const PipelineSink& sink) {
    FeatureBudget budget(processor_.features());
    // A pair that arrives within one period after it was due is late, not missed.
    SteadyClock::time_point missed = SteadyClock::now() + 2 * messagePeriod();
    LivePairing::Counts before = live_.counts();
    while (!stopped_ && !live_.finished()) {
      const std::optional<capture::FramePair> pair = live_.waitForPair(missed);
      if (pair) {
        const std::chrono::nanoseconds period = livePeriod();
        processor_.setTargetFeatureCount(budget.update(processPair(*pair, sink).times.total,
                                                       std::chrono::duration<double>(period).count()));
        missed = SteadyClock::now() + 2 * std::max(period, kShortestPeriod);
        before = live_.counts();
      } else if (!stopped_ && SteadyClock::now() >= missed) {
        const LivePairing::Counts now = live_.counts();
        if (sink.no_pair) sink.no_pair({hostNow(), cause(before, now)});
        missed = std::max(missed + messagePeriod(), SteadyClock::now());  // once, however long this was late
        before = now;
      }
    }
  }
  /// Time between two pairs, as measured from the frames.
  std::chrono::nanoseconds livePeriod() const {
    const std::chrono::nanoseconds period(live_.periods().ofPairsNs());
    return period.count() == 0 ? kFirstPeriod : std::min(period, kLongestPeriod);
  }
  /// Time between two messages about missing pairs.
  std::chrono::nanoseconds messagePeriod() const { return std::max(livePeriod(), kShortestPeriod); }
  PairResult processPair(const capture::FramePair& pair, const PipelineSink& sink) {
    PairResult result = processor_.process(pair);
    ++processed_;
    const auto offset = visual_offset_.update(
        result.estimate.rig, static_cast<double>(result.appliedCorrectionNs()), result.estimate.time_step);
    if (settings_.set_visual_offset) settings_.set_visual_offset(offset);
    sink.pair(result);
    return result;
  }
  void requireRigSize(capture::CameraSide side, const capture::Frame& frame) const {
    if (frame.image.size() == settings_.image_size) return;
    throw std::runtime_error(wrongSizeMessage(side, frame.image.size(), settings_.image_size));
  }

  capture::CameraSource& left_;
  capture::CameraSource& right_;
  PairProcessor& processor_;
  PipelineSettings settings_;
  VisualOffsetEstimator visual_offset_;
  LivePairing live_;
  Heartbeat left_beat_, right_beat_;
  std::atomic<bool> stopped_ = false;
  std::atomic<std::uint64_t> processed_ = 0;

  mutable std::mutex mutex_;
  std::optional<PairingTotals> replayed_;  // guarded by mutex_
  std::exception_ptr reader_failure_;      // guarded by mutex_
};

Pipeline::Pipeline(capture::CameraSource& left, capture::CameraSource& right, PairProcessor& processor,
                   const PipelineSettings& settings)
    : implementation_(std::make_unique<Implementation>(left, right, processor, settings)) {}
Pipeline::~Pipeline() = default;
void Pipeline::replay(const PipelineSink& sink) {
  implementation_->replay(sink);
}
void Pipeline::runLive(const PipelineSink& sink) {
  implementation_->runLive(sink);
}
void Pipeline::stop() noexcept {
  implementation_->stop();
}
PipelineCounts Pipeline::counts() const {
  return implementation_->counts();
}
std::string Pipeline::problem() const {
  return implementation_->problem();
}
std::string Pipeline::pairingProblem() const {
  return implementation_->pairingProblem();
}
std::string PipelineProgress::stalledReader(double reader_timeout) const {
  if (left_reader > reader_timeout) return "left camera's reader";
  if (right_reader > reader_timeout) return "right camera's reader";
  return {};
}

PipelineProgress Pipeline::progress() const {
  return implementation_->progress();
}

}  // namespace cartvo::pipeline
