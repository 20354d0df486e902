// Status page of a replay: stored frames, pause and step.
#include "tools/replay/replay_page.hpp"

#include <utility>

#include <fmt/format.h>

#include "daemon/page/page_frame.hpp"
#include "daemon/page/status_page.hpp"
#include "daemon/publish/odometry_publisher.hpp"
#include "tools/replay/live_publisher.hpp"

namespace cartvo {
namespace {

constexpr std::size_t kNewestSamples = 32;  // in each frame
constexpr std::chrono::seconds kHealthPeriod{1};

}  // namespace

ReplayPage::ReplayPage(const ReplayPageSettings& settings)
    : speed_(settings.speed),
      about_(daemon::aboutJson("replay", settings.title)),
      monitor_(Clock::now()),
      server_(settings.server, *this) {}

void ReplayPage::addPair(const pipeline::PairResult& result, std::size_t expected) {
  odometry_t message = daemon::odometryMessage(result);
  message.sequence = static_cast<std::int64_t>(result.sequence);
  // There is no publication: the latency is that of processing.
  message.publication_utime = message.arrival_utime + static_cast<std::int64_t>(1e6 * result.times.total);
  {
    const std::lock_guard lock(mutex_);
    total_ = expected;
    reasons_ = message.reasons;
    is_valid_ = message.status == odometry_t::VALID;
    updateHealth(result, message);
  }
  store(daemon::pageSample(message, result.times.total));
  waitForPace(result.left.exposure_ns);
}

void ReplayPage::store(const daemon::PageSample& sample) {
  const daemon::EncodedPictures pictures = daemon::encodePictures(view_.left, view_.right);
  const std::string pictures_json = daemon::picturesJson(pictures, view_, sample.sequence());
  const std::lock_guard lock(mutex_);
  history_.add(sample);
  const std::string json = fmt::format(
      R"({{"number":{0},"samples":{1},{2},"picture_number":{0},"pictures":{3}}})", sample.sequence() + 1,
      history_.newestJson(kNewestSamples), daemon::lightMembers(light()), pictures_json);
  frames_.push_back(daemon::frameBytes(json, pictures.jpeg));
  stored_bytes_ += frames_.back().size();
  while (stored_bytes_ > kMaxStoredBytes) {
    stored_bytes_ -= frames_.front().size();
    frames_.pop_front();
    ++first_;
  }
}

void ReplayPage::updateHealth(const pipeline::PairResult& result, const odometry_t& message) {
  monitor_.addPair(result, message);
  if (Clock::now() < next_health_) return;
  next_health_ = Clock::now() + kHealthPeriod;
  daemon::HealthSnapshot snapshot;
  snapshot.left.state = snapshot.right.state = capture::CameraState::streaming;
  snapshot.left.frames = snapshot.right.frames = result.sequence + 1;
  snapshot.counts.pairs = snapshot.counts.processed = result.sequence + 1;
  snapshot.features = result.features;
  health_ = monitor_.summarise(Clock::now(), snapshot);
}

void ReplayPage::waitForPace(std::int64_t exposure_ns) {
  std::unique_lock lock(mutex_);
  const auto is_free = [this] { return state_ != State::paused || std::exchange(may_step_, false); };
  if (state_ == State::paused) {
    changed_.wait(lock, is_free);
    pace_.reset();
    return;
  }
  if (speed_ <= 0.0) return;
  if (!pace_) pace_ = {Clock::now(), exposure_ns};
  const auto since = std::chrono::nanoseconds(
      static_cast<std::int64_t>(static_cast<double>(exposure_ns - pace_->second) / speed_));
  const Clock::time_point latest = Clock::now() + kMaxRecordedPause;
  if (pace_->first + since > latest) pace_ = {latest - since, pace_->second};
  changed_.wait_until(lock, pace_->first + since, [this] { return state_ == State::paused; });
  if (state_ != State::paused) return;
  changed_.wait(lock, is_free);
  pace_.reset();
}

void ReplayPage::finish() {
  const std::lock_guard lock(mutex_);
  state_ = State::ended;
}

std::optional<std::string> ReplayPage::newestFrame(std::uint64_t seen) {
  const std::lock_guard lock(mutex_);
  if (frames_.empty() || first_ + frames_.size() == seen) return std::nullopt;
  return frames_.back();
}

std::optional<std::string> ReplayPage::storedFrame(std::uint64_t pair) {
  const std::lock_guard lock(mutex_);
  if (pair < first_ || pair - first_ >= frames_.size()) return std::nullopt;
  return frames_[pair - first_];
}

std::string ReplayPage::history() {
  const std::lock_guard lock(mutex_);
  return history_.json();
}

daemon::ReplayState ReplayPage::stateForPage() const {
  constexpr const char* kNames[] = {"running", "paused", "ended"};
  return {kNames[static_cast<int>(state_)], first_, frames_.empty() ? 0 : first_ + frames_.size() - 1,
          total_};
}

/// Of the newest pair.
daemon::TrafficLight ReplayPage::light() const {
  daemon::DaemonState state;
  state.last_message = state.last_valid = Clock::now();
  if (!is_valid_) state.last_valid -= std::chrono::hours(1);
  state.reasons = reasons_;
  state.health = health_;
  state.health.left.state = state.health.right.state = camera_health_t::STREAMING;
  return daemon::trafficLight(state, state.last_message);
}

std::string ReplayPage::health() {
  const std::lock_guard lock(mutex_);
  return fmt::format("{{{},{},{}}}", daemon::healthMembers(health_), daemon::lightMembers(light()),
                     daemon::replayMembers(stateForPage()));
}

std::string ReplayPage::control(const std::string& action) {
  const std::lock_guard lock(mutex_);
  if (state_ == State::ended) return "the replay has ended";
  if (action == "replay/pause") {
    state_ = State::paused;
  } else if (action == "replay/run") {
    state_ = State::running;
  } else if (action == "replay/step") {
    may_step_ = state_ == State::paused;
    state_ = State::paused;
  } else {
    return "a replay has no such action";
  }
  changed_.notify_all();
  return {};
}

}  // namespace cartvo
