#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

#include "daemon/service/configuration.hpp"
#include "tools/camera/camera_access.hpp"
#include "tools/camera/camera_documents.hpp"
#include "tools/camera/camera_settings.hpp"
#include "tools/doctor/finding_list.hpp"

// Checks of an IP camera: whether it answers, its login, its settings.

namespace cartvo::doctor {

/// Whether a password may be sent to a camera.
enum class LoginPermission : std::uint8_t {
  allowed,
  no_password,      ///< it cannot be read
  refused_already,  ///< cartvod was refused: another attempt may lock the login
};

/// How to ask a camera.
struct CameraQuestion {
  AccessOptions access;  ///< with the side "left" or "right"
  LoginPermission login = LoginPermission::allowed;
};

/// Answer of a camera.
struct CameraAnswer {
  bool is_reachable = false;                 ///< its RTSP port
  bool is_refused = false;                   ///< it refused the password, or has locked the login
  bool may_stream = false;                   ///< a stream of its own may be opened
  std::optional<CameraDocuments> documents;  ///< nothing if the settings could not be read
};

/// Checks whether the RTSP port of a camera answers, without a request.
bool checkAddress(const daemon::Configuration& configuration, const daemon::CameraConfiguration& camera,
                  const std::atomic<bool>& interrupted, FindingList& findings);

/// Asks a Hikvision camera over ISAPI whether the login is locked, and reads its settings; one request at a
/// time. The password is sent once if it is refused. Fills in `answer`.
void askSettings(const daemon::Configuration& configuration, const CameraQuestion& question,
                 const std::atomic<bool>& interrupted, CameraAnswer& answer, FindingList& findings);

/// Compares the settings of the cameras (nothing: not read) with those that odometry needs. `findings`: of
/// the left and the right camera, and of both.
void checkSettings(const std::array<const CameraDocuments*, 2>& cameras, const OdometryNeeds& needs,
                   std::array<FindingList*, 3> findings);

}  // namespace cartvo::doctor
