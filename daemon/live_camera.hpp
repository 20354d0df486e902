#pragma once

#include <memory>

#include "capture/camera_side.hpp"
#include "capture/rtsp_camera.hpp"
#include "capture/v4l2_camera.hpp"
#include "daemon/configuration.hpp"

namespace cartvo {

/// How a configured IP camera is reached; reads its password, see readPassword.
RtspCameraSettings rtspSettings(const Configuration& configuration, const CameraConfiguration& camera);

/// How a configured camera of this computer is set; `size`: px, the rig's, if the configuration has none.
/// Throws std::runtime_error if neither has.
V4l2CameraSettings v4l2Settings(const Configuration& configuration, const CameraConfiguration& camera,
                                const cv::Size& size);

/// A camera as configured, of either kind.
class LiveCamera {
 public:
  /// `size`: px, the rig's, or empty without one. An IP camera's pictures are stamped by `clock`, which must
  /// outlive it. Throws what readPassword and v4l2Settings throw.
  LiveCamera(const Configuration& configuration, CameraSide side, const cv::Size& size, PairClock& clock);

  CameraSource& source() { return *source_; }
  const CameraSource& source() const { return *source_; }

  /// Hands what an IP camera sends to `observer`, which must outlive it; before the first read. False if this
  /// camera sends pictures that are not encoded, which are not recorded.
  bool observe(StreamObserver& observer);

  /// The longest a reader may take to go round, s: twice what the camera may spend on opening a connection or
  /// on waiting for a silent one.
  double longestTurn() const { return longest_turn_; }

 private:
  void connect(const RtspCameraSettings& settings, CameraSide side, PairClock& clock);

  std::unique_ptr<CameraSource> source_;
  RtspCamera* rtsp_ = nullptr;  ///< the same, if it is one
  double longest_turn_ = 0.0;
};

}  // namespace cartvo
