#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "capture/camera_source.hpp"

namespace cartvo {

/// Wraps a live camera for a consumer that is slower than the stream: a thread reads the camera continuously,
/// since an unread stream loses data, and read() returns the newest frame.
class NewestFrame : public capture::CameraSource {
 public:
  /// `camera` must outlive this.
  explicit NewestFrame(capture::CameraSource& camera);
  ~NewestFrame() override;
  NewestFrame(const NewestFrame&) = delete;
  NewestFrame& operator=(const NewestFrame&) = delete;

  /// The newest good frame that was not returned before.
  capture::ReadOutcome read(capture::Frame& frame, std::chrono::milliseconds timeout) override;
  capture::CameraHealth health() const override { return camera_.health(); }
  void interrupt() noexcept override { camera_.interrupt(); }

 private:
  void readAll();

  capture::CameraSource& camera_;
  std::mutex mutex_;
  std::condition_variable changed_;
  capture::Frame newest_;
  bool is_new_ = false;
  bool ended_ = false;
  std::thread reader_;
};

}  // namespace cartvo
