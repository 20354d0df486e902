// Live status page: handover of pairs, the thread that turns them into frames, the server's answers.
#include "daemon/page/status_page.hpp"

#include <limits>
#include <utility>

#include <fmt/format.h>

#include "common/host_clock.hpp"
#include "common/threads/thread_priority.hpp"

namespace cartvo::daemon {
namespace {

constexpr std::chrono::milliseconds kViewPeriod{100}, kPicturePeriod{200};
constexpr std::chrono::nanoseconds kViewerSilence = std::chrono::seconds(2);

constexpr std::chrono::milliseconds kWatchedPeriod{40}, kUnwatchedPeriod{250};
constexpr std::chrono::milliseconds kLongestPairPeriod{600};  // then each camera's own picture is shown
constexpr std::size_t kNewestSamples = 32;                    // in each frame: 0.5 s of 60 Hz

std::string sampleNames() {
  std::string json = "[";
  for (const char* name : kSampleFields)
    json += fmt::format("{}\"{}\"", json.size() > 1 ? "," : "", name);
  return json + "]";
}

}  // namespace

bool LiveHandover::hasViewer(Clock::time_point now) const {
  const std::int64_t last = last_viewer_ns_;
  return last != 0 && now.time_since_epoch().count() - last < kViewerSilence.count();
}

pipeline::PairView* LiveHandover::nextViewAt(Clock::time_point now) {
  is_filled_ = false;
  if (!hasViewer(now)) return nullptr;
  if (now < next_view_) return nullptr;
  next_view_ += kViewPeriod;  // ten a second on average, whatever the frame rate
  if (next_view_ <= now) next_view_ = now + kViewPeriod;
  if (!filling_) filling_ = used_.take();
  if (!filling_) filling_ = std::make_unique<PageSnapshot>();
  is_filled_ = true;
  return &filling_->view;
}

void LiveHandover::addPair(const PageSample& sample) {
  samples_.push(sample);
  if (!std::exchange(is_filled_, false)) return;
  filling_->sequence = sample.sequence();
  filling_ = snapshots_.put(std::move(filling_));
}

void LiveHandover::addFrame(capture::CameraSide side, const cv::Mat& picture, Clock::time_point now) {
  Camera& camera = cameras_[static_cast<std::size_t>(side)];
  camera.last_ns = now.time_since_epoch().count();
  if (!hasViewer(now) || now < camera.next_picture) return;
  camera.next_picture = now + kPicturePeriod;
  camera.picture.put(std::make_unique<cv::Mat>(picture.clone()));
}

CameraView LiveHandover::takeCamera(capture::CameraSide side, Clock::time_point now) {
  Camera& camera = cameras_[static_cast<std::size_t>(side)];
  const std::int64_t last = camera.last_ns;
  const std::unique_ptr<cv::Mat> picture = camera.picture.take();
  return {picture ? *picture : cv::Mat(),
          last == 0 ? std::numeric_limits<double>::quiet_NaN()
                    : std::chrono::duration<double>(now.time_since_epoch() - Clock::duration(last)).count()};
}

std::string aboutJson(const std::string& mode, const std::string& title) {
  return fmt::format(R"({{"mode":"{}","start":{},"version":"{}","title":{},"sample":{}}})", mode,
                     wallClockNow() / 1000, CARTVO_VERSION, jsonText(title), sampleNames());
}

StatusPage::StatusPage(const PageServerSettings& settings, const std::string& title,
                       RecordingControl recording)
    : about_(aboutJson("live", title)), recording_(std::move(recording)), server_(settings, *this) {
  {
    const std::lock_guard lock(mutex_);  // the server answers already
    state_.last_message = Clock::now();
    state_.last_valid = state_.last_message - std::chrono::hours(1);
  }
  thread_ = std::jthread([this](const std::stop_token& end) { run(end); });
}

void StatusPage::run(const std::stop_token& end) {
  lowerThreadPriority();
  std::unique_lock lock(mutex_);
  while (!end.stop_requested()) {
    const bool has_samples = addSamples();
    updateHealth();
    const bool is_watched = handover_.hasViewer(Clock::now());
    if (is_watched && has_samples) {
      lock.unlock();
      addPictures();
      lock.lock();
      renderFrame();
    }
    wake_.wait_for(lock, end, is_watched ? kWatchedPeriod : kUnwatchedPeriod, [] { return false; });
  }
}

bool StatusPage::addSamples() {
  bool has_samples = false;
  while (const std::optional<PageSample> sample = handover_.nextSample()) {
    history_.add(*sample);
    state_.last_message = Clock::now();
    state_.reasons = sample->reasons();
    if (sample->isValid()) state_.last_valid = state_.last_message;
    has_samples = true;
  }
  return has_samples;
}

void StatusPage::updateHealth() {
  const std::unique_ptr<PageHealth> newest = handover_.takeHealth();
  if (!newest) return;
  state_.health = newest->health;
  state_.stalled = newest->stalled;
  recording_state_ = newest->recording;
}

/// Encodes the newest pair, or, while none comes, the newest picture of each camera. Without the lock: only
/// this thread writes what it writes.
void StatusPage::addPictures() {
  const Clock::time_point now = Clock::now();
  const bool is_unpaired = (history_.newest().reasons() & odometry_t::REASON_NO_PAIR) != 0;
  bool has_new = false;
  for (const capture::CameraSide side : {capture::CameraSide::left, capture::CameraSide::right}) {
    CameraView camera = handover_.takeCamera(side, now);
    const auto i = static_cast<std::size_t>(side);
    frame_ages_[i] = camera.age;
    if (camera.picture.empty()) continue;
    camera_pictures_[i] = std::move(camera.picture);
    has_new = true;
  }
  if (std::unique_ptr<PageSnapshot> snapshot = handover_.takeSnapshot()) {
    last_pair_ = now;
    pictures_ = encodePictures(snapshot->view.left, snapshot->view.right);
    pictures_json_ = picturesJson(pictures_, snapshot->view, snapshot->sequence);
    handover_.recycle(std::move(snapshot));
  } else if (has_new && is_unpaired && now - last_pair_ > kLongestPairPeriod) {
    pictures_ = encodePictures(camera_pictures_[0], camera_pictures_[1]);
    pictures_json_ = unpairedJson(pictures_);
  } else {
    return;
  }
  ++picture_number_;
}

void StatusPage::renderFrame() {
  std::string ages;
  for (const double age : frame_ages_) {
    if (!ages.empty()) ages += ',';
    appendNumber(age, 4, ages);
  }
  const std::string json =
      fmt::format(R"({{"number":{},"samples":{},{},"frame_ages_s":[{}],"picture_number":{},"pictures":{}}})",
                  ++frame_number_, history_.newestJson(kNewestSamples),
                  lightMembers(trafficLight(state_, Clock::now())), ages, picture_number_, pictures_json_);
  frame_ = frameBytes(json, pictures_.jpeg);
}

std::optional<std::string> StatusPage::newestFrame(std::uint64_t seen) {
  handover_.noteViewer();
  const std::lock_guard lock(mutex_);
  if (frame_number_ == 0 || frame_number_ == seen) return std::nullopt;
  return frame_;
}

std::string StatusPage::history() {
  const std::lock_guard lock(mutex_);
  return history_.json();
}

std::string StatusPage::health() {
  const std::lock_guard lock(mutex_);
  return fmt::format("{{{},{},{}}}", healthMembers(state_.health),
                     lightMembers(trafficLight(state_, Clock::now())), recordingMembers(recording_state_));
}

std::string StatusPage::control(const std::string& action) {
  if (action == "recording/start" && recording_.start) return recording_.start();
  if (action == "recording/stop" && recording_.stop) return recording_.stop();
  return "there is nothing to do this with";
}

void StatusPage::addPair(const pipeline::PairResult& result, const odometry_t& message) {
  handover_.addPair(pageSample(message, result.times.total));
}
void StatusPage::addMissedPair(const odometry_t& message) {
  handover_.addMissedPair(pageSample(message, std::numeric_limits<double>::quiet_NaN()));
}

}  // namespace cartvo::daemon
