#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>

#include <opencv2/core/types.hpp>

#include "capture/camera_source.hpp"
#include "capture/v4l2/v4l2_picture.hpp"

// Frame source for a camera of this computer (Video4Linux2).

namespace cartvo::capture {

/// Settings of one V4L2 camera.
struct V4l2CameraSettings {
  std::filesystem::path device;  ///< such as /dev/video0, or a persistent link to it
  cv::Size size;                 ///< px
  double frame_rate = 18.0;      ///< Hz
  std::optional<PixelFormat>
      format;                      ///< nothing: the first of GREY, NV12, YUYV, MJPEG that the camera offers
  std::optional<double> exposure;  ///< exposure time, s; nothing: unchanged
  std::optional<int> gain;         ///< in the driver's unit; nothing: unchanged

  std::chrono::milliseconds stall_timeout{1000};  ///< limit without a picture; then it is opened again
  std::chrono::milliseconds frozen_after{
      5000};                             ///< duration of an unchanged picture until CameraState::frozen
  std::chrono::milliseconds retry{500};  ///< pause before it is opened again
};

/// One camera of this computer, through the kernel's Video4Linux2. Opens it, and reopens it without limit
/// after it was unplugged or stalled. Has no thread: `read` waits in the caller's thread.
///
/// Exposures are the kernel's time stamps by this host's monotonic clock, converted to its real-time clock at
/// each picture. Both cameras of a pair are stamped by one clock. The delay of a driver's time stamp (first
/// or last packet of a picture) is equal for two cameras of the same model and settings.
class V4l2Camera : public CameraSource {
 public:
  /// Validates the settings; the first `read` opens the camera. Throws std::invalid_argument if a setting is
  /// out of range.
  explicit V4l2Camera(const V4l2CameraSettings& settings);
  ~V4l2Camera() override;
  V4l2Camera(const V4l2Camera&) = delete;
  V4l2Camera& operator=(const V4l2Camera&) = delete;

  /// Takes at most `timeout`, plus the time the driver needs to open the camera.
  ReadOutcome read(Frame& frame, std::chrono::milliseconds timeout) override;
  CameraHealth health() const override;
  void interrupt() noexcept override;

 private:
  class Receiver;
  std::unique_ptr<Receiver> receiver_;
};

}  // namespace cartvo::capture
