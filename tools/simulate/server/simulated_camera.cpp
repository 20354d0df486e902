// One simulated IP camera: sends each picture when it is due.
#include "tools/simulate/server/simulated_camera.hpp"

#include <condition_variable>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>

#include "tools/simulate/server/frame_schedule.hpp"
#include "tools/simulate/server/rtsp_server.hpp"

namespace cartvo::simulate {
namespace {

using SystemClock = std::chrono::system_clock;

SimulatedCameraSettings validated(SimulatedCameraSettings settings) {
  if (settings.password.empty()) throw std::invalid_argument("a simulated camera needs a password");
  if (settings.switched_on_ns == 0) {
    settings.switched_on_ns = std::chrono::nanoseconds(SystemClock::now().time_since_epoch()).count();
  }
  return settings;
}

}  // namespace

class SimulatedCamera::Implementation {
 public:
  Implementation(std::shared_ptr<const EncodedStream> stream, const SimulatedCameraSettings& settings)
      : settings_(validated(settings)),
        stream_(std::move(stream)),
        schedule_(stream_, settings_.switched_on_ns, settings_.repeat_after_ns),
        server_(settings_),
        thread_([this] { sendScheduledPictures(); }) {}

  ~Implementation() {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }

  void startContent(std::int64_t epoch_ns) {
    {
      const std::lock_guard lock(mutex_);
      schedule_.startContent(epoch_ns);
    }
    changed_.notify_all();
  }

  bool isFinished() const {
    const std::lock_guard lock(mutex_);
    return finished_;
  }

  const SimulatedCameraSettings& settings() const { return settings_; }
  const RtspServer& server() const { return server_; }

 private:
  SystemClock::time_point due(const ScheduledUnit& next) const {
    return SystemClock::time_point(std::chrono::duration_cast<SystemClock::duration>(
        std::chrono::nanoseconds(next.instant_ns) + settings_.latency));
  }

  void sendScheduledPictures() {
    std::unique_lock lock(mutex_);
    while (!stopping_) {
      const std::optional<ScheduledUnit> next = schedule_.next();
      if (!next) break;
      // Notified early: startContent() may have changed the next picture.
      if (changed_.wait_until(lock, due(*next)) == std::cv_status::no_timeout) continue;
      schedule_.advance();
      lock.unlock();
      server_.clients().send(stream_, *next->unit, next->instant_ns);
      lock.lock();
    }
    if (stopping_) return;
    finished_ = true;
    lock.unlock();
    server_.clients().sendEnd();
  }

  SimulatedCameraSettings settings_;
  std::shared_ptr<const EncodedStream> stream_;
  mutable std::mutex mutex_;  ///< guards schedule_, stopping_, finished_
  std::condition_variable changed_;
  FrameSchedule schedule_;
  bool stopping_ = false;
  bool finished_ = false;
  RtspServer server_;
  std::thread thread_;
};

SimulatedCamera::SimulatedCamera(std::shared_ptr<const EncodedStream> stream,
                                 const SimulatedCameraSettings& settings)
    : implementation_(std::make_unique<Implementation>(std::move(stream), settings)) {}

SimulatedCamera::~SimulatedCamera() = default;

std::uint16_t SimulatedCamera::port() const {
  return implementation_->server().port();
}

std::string SimulatedCamera::url() const {
  return "rtsp://" + implementation_->settings().address + ":" + std::to_string(port()) +
         "/Streaming/Channels/101";
}

void SimulatedCamera::startContent(std::int64_t epoch_ns) {
  implementation_->startContent(epoch_ns);
}

int SimulatedCamera::playingClients() const {
  return implementation_->server().clients().playingCount();
}

bool SimulatedCamera::isFinished() const {
  return implementation_->isFinished();
}

}  // namespace cartvo::simulate
