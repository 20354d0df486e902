// Builds the cameras named in the configuration.
#include "daemon/service/live_camera.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <stdexcept>
#include <string>
#include <utility>

#include "capture/isapi/isapi_client.hpp"
#include "capture/rtsp/rtsp_url.hpp"
#include "daemon/service/camera_password.hpp"

namespace cartvo::daemon {
namespace {

/// Time that a V4L2 driver may need to open a camera; some wait for the hardware.
constexpr std::chrono::seconds kMaxOpenTime{3};

// Pictures up to these sizes are decoded, so that the message about a wrong size can tell it.
constexpr std::int64_t kMaxPixelRatio = 4;          // of the rig's
constexpr std::int64_t kRefusedPixels = 9'000'000;  // 4K

constexpr double kDefaultV4l2Rate = 18.0;  // Hz

double twice(std::chrono::milliseconds duration) {
  return 2.0 * std::chrono::duration<double>(duration).count();
}

}  // namespace

capture::RtspCameraSettings rtspSettings(const Configuration& configuration,
                                         const CameraConfiguration& camera) {
  capture::RtspCameraSettings settings;
  settings.url = camera.url;
  settings.credentials = {camera.username, readPassword(camera)};
  settings.transport = configuration.transport;
  settings.basic_authentication = configuration.basic_authentication;
  settings.answer_timeout = configuration.answer_timeout;
  settings.connect_timeout = configuration.connect_timeout;
  settings.stall_timeout = configuration.stall_timeout;
  const capture::HttpAddress address{capture::parseRtspUrl(camera.url).host, capture::kHttpPort, false};
  settings.ask_about_refusal = [address,
                                timeout = settings.answer_timeout](const std::atomic<bool>& interrupted) {
    return askAboutRefusedLogin(address, timeout, interrupted);
  };
  return settings;
}

capture::V4l2CameraSettings v4l2Settings(const Configuration& configuration,
                                         const CameraConfiguration& camera, const cv::Size& size) {
  capture::V4l2CameraSettings settings;
  settings.device = camera.device();
  settings.size = camera.size.empty() ? size : camera.size;
  if (settings.size.empty()) {
    throw std::runtime_error("cameras." +
                             std::string(camera.url == configuration.left.url ? "left" : "right") +
                             ".size is missing: without a rig file the image size must be configured");
  }
  settings.frame_rate = configuration.frame_rate.value_or(kDefaultV4l2Rate);
  settings.format = camera.format;
  settings.exposure = camera.exposure;
  settings.gain = camera.gain;
  settings.stall_timeout = configuration.stall_timeout;
  return settings;
}

LiveCamera::LiveCamera(const Configuration& configuration, capture::CameraSide side, const cv::Size& size,
                       capture::StereoTimestamper& clock) {
  const CameraConfiguration& camera =
      side == capture::CameraSide::left ? configuration.left : configuration.right;
  if (camera.isV4l2()) {
    source_ = std::make_unique<capture::V4l2Camera>(v4l2Settings(configuration, camera, size));
    reader_timeout_ = twice(std::max<std::chrono::milliseconds>(kMaxOpenTime, configuration.stall_timeout));
  } else {
    capture::RtspCameraSettings settings = rtspSettings(configuration, camera);
    settings.max_pixels = std::max(kRefusedPixels, kMaxPixelRatio * size.width * size.height);
    connect(settings, side, clock);
  }
}

void LiveCamera::connect(const capture::RtspCameraSettings& settings, capture::CameraSide side,
                         capture::StereoTimestamper& clock) {
  auto camera = std::make_unique<capture::RtspCamera>(settings);
  camera->setTimestamper(clock, side);
  rtsp_ = camera.get();
  source_ = std::move(camera);
  reader_timeout_ =
      twice(std::max(2 * settings.answer_timeout + settings.connect_timeout, settings.stall_timeout));
}

bool LiveCamera::observe(capture::StreamObserver& observer) {
  if (rtsp_ != nullptr) rtsp_->setObserver(observer);
  return rtsp_ != nullptr;
}

capture::RefusedLogin askAboutRefusedLogin(const capture::HttpAddress& address,
                                           std::chrono::milliseconds timeout,
                                           const std::atomic<bool>& interrupted) {
  try {
    capture::IsapiSettings settings;
    settings.address = address;
    settings.timeout = timeout;
    capture::IsapiClient client(settings);
    client.setInterruption(interrupted);
    const capture::LoginState state = client.loginState();
    return {state.unlock_after, capture::loginStateText(state)};
  } catch (const std::exception&) {
    return {};  // other makers' cameras, and those that serve only HTTPS
  }
}

}  // namespace cartvo::daemon
