#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "capture/camera_source.hpp"

namespace cartvo {

/// A live camera whose frames nobody waits for: a thread reads it all the time, for a stream that is not read
/// loses data, and hands out the newest frame.
class NewestFrame : public CameraSource {
 public:
  /// `camera` must outlive this.
  explicit NewestFrame(CameraSource& camera);
  ~NewestFrame() override;
  NewestFrame(const NewestFrame&) = delete;
  NewestFrame& operator=(const NewestFrame&) = delete;

  /// The newest good frame, if it was not handed out before.
  ReadOutcome read(Frame& frame, std::chrono::milliseconds timeout) override;
  CameraHealth health() const override { return camera_.health(); }
  void interrupt() noexcept override { camera_.interrupt(); }

 private:
  void readAll();

  CameraSource& camera_;
  std::mutex mutex_;
  std::condition_variable changed_;
  Frame newest_;
  bool is_new_ = false;
  bool ended_ = false;
  std::thread reader_;
};

}  // namespace cartvo
