#pragma once

#include <atomic>
#include <memory>

#include "capture/camera_side.hpp"
#include "capture/isapi/http_connection.hpp"
#include "capture/rtsp/rtsp_camera.hpp"
#include "capture/v4l2/v4l2_camera.hpp"
#include "daemon/service/configuration.hpp"

// Live cameras, RTSP or V4L2, as the configuration describes them.

namespace cartvo::daemon {

/// Connection settings of a configured IP camera; reads its password (readPassword).
capture::RtspCameraSettings rtspSettings(const Configuration& configuration,
                                         const CameraConfiguration& camera);

/// Settings of a configured V4L2 camera. `size`: the rig's image size, px, used if the configuration gives
/// none. Throws std::runtime_error if both are empty.
capture::V4l2CameraSettings v4l2Settings(const Configuration& configuration,
                                         const CameraConfiguration& camera, const cv::Size& size);

/// A configured camera, RTSP or V4L2.
class LiveCamera {
 public:
  /// `size`: the rig's image size, px, or empty without a rig. `clock` timestamps the pictures of an IP
  /// camera and must outlive it. Throws as readPassword and v4l2Settings do.
  LiveCamera(const Configuration& configuration, capture::CameraSide side, const cv::Size& size,
             capture::StereoTimestamper& clock);

  capture::CameraSource& source() { return *source_; }
  const capture::CameraSource& source() const { return *source_; }

  /// Passes the encoded stream of an IP camera to `observer`, which must outlive the camera. Call it before
  /// the first read. Returns false for a V4L2 camera, which has no encoded stream.
  bool observe(capture::StreamObserver& observer);

  /// Maximum time between two reads before the reader counts as stalled, s: twice the time the camera may
  /// need to open a connection or to detect that no data arrive.
  double readerTimeout() const { return reader_timeout_; }

 private:
  void connect(const capture::RtspCameraSettings& settings, capture::CameraSide side,
               capture::StereoTimestamper& clock);

  std::unique_ptr<capture::CameraSource> source_;
  capture::RtspCamera* rtsp_ = nullptr;  ///< `source_` if it is an RTSP camera
  double reader_timeout_ = 0.0;
};

/// Asks a Hikvision camera over ISAPI, without a password, why it refused a login: whether and for how long
/// it has locked it, and how many attempts are left. Empty if the camera does not answer or does not say.
/// Does not throw. `timeout`: of the one request.
capture::RefusedLogin askAboutRefusedLogin(const capture::HttpAddress& address,
                                           std::chrono::milliseconds timeout,
                                           const std::atomic<bool>& interrupted);

}  // namespace cartvo::daemon
