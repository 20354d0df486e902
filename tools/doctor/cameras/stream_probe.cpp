// Receives both cameras' streams as cartvod does.
#include "tools/doctor/cameras/stream_probe.hpp"

#include <algorithm>
#include <chrono>
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

/// Time in which a camera must have sent its first picture.
milliseconds patience(const daemon::Configuration& configuration) {
  constexpr milliseconds kMargin{1000};
  return 2 * configuration.answer_timeout + configuration.connect_timeout + kMargin;
}

/// Reads one camera until the time is over or the camera is given up.
void readCamera(capture::CameraSource& source, capture::CameraSide side, milliseconds first_picture,
                std::chrono::duration<double> duration, StreamMeasurement& measurement,
                LivePairKeeper& pairs) {
  constexpr milliseconds kTimeout{100};
  Clock::time_point end = Clock::now() + first_picture;
  bool has_frame = false;
  capture::Frame frame;
  while (Clock::now() < end && source.health().state != capture::CameraState::refused) {
    const capture::ReadOutcome outcome = source.read(frame, kTimeout);
    if (outcome == capture::ReadOutcome::ended) break;
    if (outcome != capture::ReadOutcome::frame) continue;
    if (!has_frame) end = Clock::now() + std::chrono::duration_cast<Clock::duration>(duration);
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
      readCamera(camera_.source(), side, patience(configuration),
                 std::chrono::duration<double>(settings.seconds), measurement, pairs);
    });
  }
  ~ProbedCamera() { camera_.source().interrupt(); }
  ProbedCamera(const ProbedCamera&) = delete;
  ProbedCamera& operator=(const ProbedCamera&) = delete;

  bool isDone() const { return done_.wait_for(milliseconds(0)) == std::future_status::ready; }
  void interrupt() { camera_.source().interrupt(); }
  void wait() { done_.get(); }

 private:
  Observer observer_;
  daemon::LiveCamera camera_;
  std::future<void> done_;  ///< waits for the thread when it is destroyed
};

}  // namespace

Probe probeStreams(const daemon::Configuration& configuration, const ProbeSettings& settings,
                   const std::atomic<bool>& interrupted) {
  Probe probe;
  capture::StereoTimestamper clock(configuration.clock);
  LivePairKeeper pairs;
  std::array<std::unique_ptr<ProbedCamera>, 2> cameras;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    if (!settings.cameras[i]) continue;
    try {
      cameras[i] = std::make_unique<ProbedCamera>(configuration, static_cast<capture::CameraSide>(i),
                                                  settings, clock, probe.streams[i], pairs);
    } catch (const std::exception& error) {
      probe.streams[i].problem = error.what();
    }
  }
  const auto is_done = [](const auto& camera) { return !camera || camera->isDone(); };
  while (!(is_done(cameras[0]) && is_done(cameras[1])) && !interrupted)
    std::this_thread::sleep_for(milliseconds(20));
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
