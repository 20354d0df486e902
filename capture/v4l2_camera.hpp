#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>

#include <opencv2/core/types.hpp>

#include "capture/camera_source.hpp"
#include "capture/v4l2_picture.hpp"

namespace cartvo {

struct V4l2CameraSettings {
  std::filesystem::path device;  ///< such as /dev/video0, or a link to it that survives a reboot
  cv::Size size;                 ///< px
  double frame_rate = 18.0;      ///< Hz
  std::optional<PixelFormat>
      format;                      ///< nothing: the first of GREY, NV12, YUYV, MJPEG that the camera offers
  std::optional<double> exposure;  ///< s; nothing: as the camera is set
  std::optional<int> gain;         ///< in the driver's unit; nothing: as the camera is set

  std::chrono::milliseconds stall_timeout{1000};  ///< without a picture for so long, it is opened again
  std::chrono::milliseconds frozen_after{5000};   ///< the same picture for so long is a fault to be told
  std::chrono::milliseconds retry{500};           ///< pause before it is opened again
};

/// One camera on this computer, through the kernel's Video4Linux2. Opens it, and for ever again after it was
/// unplugged or fell silent. No thread of its own: `read` waits in the caller's.
///
/// Exposures are the kernel's stamps, by the monotonic clock of this host, related to its real-time clock at
/// each picture. The two cameras of a pair are stamped by one clock; what a driver's stamp is late by (the
/// first packet of a picture, or its last) is the same for two cameras of one model and settings.
class V4l2Camera : public CameraSource {
 public:
  /// Checks the settings only; the first `read` opens the camera. Throws std::invalid_argument for settings
  /// that make no sense.
  explicit V4l2Camera(const V4l2CameraSettings& settings);
  ~V4l2Camera() override;
  V4l2Camera(const V4l2Camera&) = delete;
  V4l2Camera& operator=(const V4l2Camera&) = delete;

  /// Never longer than `timeout`, but for what the driver takes to open the camera.
  ReadOutcome read(Frame& frame, std::chrono::milliseconds timeout) override;
  CameraHealth health() const override;
  void interrupt() noexcept override;

 private:
  class Receiver;
  std::unique_ptr<Receiver> receiver_;
};

}  // namespace cartvo
