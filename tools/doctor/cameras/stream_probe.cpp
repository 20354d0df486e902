// Receives both cameras' streams as cartvod does.
#include "tools/doctor/cameras/stream_probe.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <exception>
#include <future>
#include <memory>
#include <thread>

#include "daemon/service/live_camera.hpp"
#include "tools/doctor/cameras/kept_pairs.hpp"

namespace cartvo::doctor {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

/// Keeps what is known of each received picture of the last connection.
class Observer : public capture::StreamObserver {
 public:
  explicit Observer(StreamMeasurement& measurement) : measurement_(measurement) {}

  void onStream(const capture::StreamFormat& format) noexcept override {
    measurement_.codec = format.codec;
    measurement_.pictures.clear();
  }

  void onUnit(const capture::EncodedUnit& unit) noexcept override {
    if (measurement_.pictures.size() < kMaxPictures) measurement_.pictures.push_back(receivedPicture(unit));
  }

 private:
  static constexpr std::size_t kMaxPictures = 1'000'000;

  StreamMeasurement& measurement_;
};

void addFrame(const capture::Frame& frame, StreamMeasurement& measurement) {
  measurement.size = frame.image.size();
  if (frame.arrival_ns > 0)
    measurement.decode_times.push_back(1e-9 * static_cast<double>(frame.decoded_ns - frame.arrival_ns));
  if (measurement.codec) return;
  measurement.pictures.push_back({.time_ns = frame.exposure_ns, .sequence = frame.sequence});
}

Clock::duration durationOf(const ProbeSettings& settings) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(settings.seconds));
}

/// Time in which a camera must have sent its first picture.
milliseconds patience(const daemon::Configuration& configuration) {
  constexpr milliseconds kMargin{1000};
  return 2 * configuration.answer_timeout + configuration.connect_timeout + kMargin;
}

/// Reads one camera until the time is over or the camera is given up. Sets `end` at the first picture.
void readCamera(capture::CameraSource& source, capture::CameraSide side, milliseconds first_picture,
                Clock::duration duration, std::atomic<Clock::time_point>& end, StreamMeasurement& measurement,
                LivePairKeeper& pairs) {
  constexpr milliseconds kTimeout{100};
  const Clock::time_point given_up = Clock::now() + first_picture;
  bool has_frame = false;
  capture::Frame frame;
  while (Clock::now() < (has_frame ? end.load() : given_up) &&
         source.health().state != capture::CameraState::refused) {
    const capture::ReadOutcome outcome = source.read(frame, kTimeout);
    if (outcome == capture::ReadOutcome::ended) break;
    if (outcome != capture::ReadOutcome::frame) continue;
    if (!has_frame) end = Clock::now() + duration;
    has_frame = true;
    addFrame(frame, measurement);
    pairs.add(side, frame);
  }
  const capture::CameraHealth health = source.health();
  measurement.is_refused = health.state == capture::CameraState::refused;
  measurement.problem = health.last_error.empty() ? health.advice : health.last_error;
  if (measurement.is_refused)
    measurement.problem.erase(
        std::min(measurement.problem.size(), measurement.problem.find("; trying again")));
}

/// One camera, read in a thread of its own.
class ProbedCamera {
 public:
  ProbedCamera(const daemon::Configuration& configuration, capture::CameraSide side,
               const ProbeSettings& settings, capture::StereoTimestamper& clock,
               StreamMeasurement& measurement, LivePairKeeper& pairs)
      : observer_(measurement), camera_(configuration, side, settings.size, clock) {
    camera_.observe(observer_);
    done_ = std::async(std::launch::async, [this, side, &configuration, &settings, &measurement, &pairs] {
      readCamera(camera_.source(), side, patience(configuration), durationOf(settings), end_, measurement,
                 pairs);
    });
  }
  ~ProbedCamera() { camera_.source().interrupt(); }
  ProbedCamera(const ProbedCamera&) = delete;
  ProbedCamera& operator=(const ProbedCamera&) = delete;

  /// Time that is left of the measurement; all of it before the first picture.
  Clock::duration left(Clock::duration whole) const {
    if (isDone()) return Clock::duration::zero();
    const Clock::time_point end = end_;
    return end == Clock::time_point{} ? whole : end - Clock::now();
  }
  bool isDone() const { return done_.wait_for(milliseconds(0)) == std::future_status::ready; }
  void interrupt() { camera_.source().interrupt(); }
  void wait() { done_.get(); }

 private:
  Observer observer_;
  daemon::LiveCamera camera_;
  std::atomic<Clock::time_point> end_{Clock::time_point{}};  ///< zero before the first picture
  std::future<void> done_;                                   ///< waits for the thread when it is destroyed
};

using ProbedCameras = std::array<std::unique_ptr<ProbedCamera>, 2>;

void waitForCameras(const ProbedCameras& cameras, Clock::duration whole,
                    const WorkObserver::Progress& progress, const std::atomic<bool>& interrupted) {
  constexpr milliseconds kPause{20};
  using Seconds = std::chrono::duration<double>;
  const auto is_done = [](const auto& camera) { return !camera || camera->isDone(); };
  const int total = static_cast<int>(std::ceil(Seconds(whole).count()));
  while (!(is_done(cameras[0]) && is_done(cameras[1])) && !interrupted) {
    Clock::duration left = Clock::duration::zero();
    for (const auto& camera : cameras)
      if (camera) left = std::max(left, camera->left(whole));
    progress(total - static_cast<int>(std::ceil(Seconds(left).count())), total);
    std::this_thread::sleep_for(kPause);
  }
}

}  // namespace

Probe probeStreams(const daemon::Configuration& configuration, const ProbeSettings& settings,
                   const WorkObserver::Progress& progress, const std::atomic<bool>& interrupted) {
  Probe probe;
  capture::StereoTimestamper clock(configuration.clock);
  LivePairKeeper pairs;
  ProbedCameras cameras;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    if (!settings.cameras[i]) continue;
    try {
      cameras[i] = std::make_unique<ProbedCamera>(configuration, static_cast<capture::CameraSide>(i),
                                                  settings, clock, probe.streams[i], pairs);
    } catch (const std::exception& error) {
      probe.streams[i].problem = error.what();
    }
  }
  waitForCameras(cameras, durationOf(settings), progress, interrupted);
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    if (!cameras[i]) continue;
    if (interrupted) cameras[i]->interrupt();
    try {
      cameras[i]->wait();
    } catch (const std::exception& error) {
      probe.streams[i].problem = error.what();
    }
  }
  probe.pairs = pairs.take();
  return probe;
}

}  // namespace cartvo::doctor
