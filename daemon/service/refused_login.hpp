#pragma once

#include <atomic>

#include "capture/isapi/http_connection.hpp"
#include "capture/rtsp/rtsp_camera.hpp"

namespace cartvo::daemon {

/// Asks a Hikvision camera over ISAPI, without a password, why it refused a login: whether and for how long
/// it has locked it, and how many attempts are left. Empty if the camera does not answer or does not say.
/// Does not throw. `timeout`: of the one request.
capture::RefusedLogin askAboutRefusedLogin(const capture::HttpAddress& address,
                                           std::chrono::milliseconds timeout,
                                           const std::atomic<bool>& interrupted);

}  // namespace cartvo::daemon
