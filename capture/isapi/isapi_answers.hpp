#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

// Answers of Hikvision cameras beside documents: the state of a login and the result of a request.

namespace cartvo::capture {

/// State of the login at a camera, from the body of a 401 answer or of /ISAPI/Security/userCheck.
struct LoginState {
  std::optional<bool> locked;                        ///< nothing: the camera does not say
  std::optional<std::chrono::seconds> unlock_after;  ///< of a locked login, positive; nothing: not known
  std::optional<int> attempts_left;                  ///< until the camera locks the login
  std::optional<bool> activated;  ///< false: the camera has no password yet and does nothing else

  bool isLocked() const { return locked.value_or(false); }
};

/// Unknown and damaged bodies give an empty state.
LoginState parseLoginState(std::string_view body);

/// "the camera has locked this login for another 1800 s", "3 attempts are left before the camera locks the
/// login"; empty if nothing is known.
std::string loginStateText(const LoginState& state);

/// Result of a request (ResponseStatus).
struct ResponseStatus {
  enum class Code : std::uint8_t {
    unknown = 0,
    ok = 1,
    busy = 2,
    device_error = 3,
    invalid_operation = 4,
    invalid_xml_format = 5,
    invalid_xml_content = 6,
    reboot_required = 7,
  };
  Code code = Code::unknown;
  std::string sub_code;  ///< printable, for example "notSupport", "lowPrivilege"
  std::string text;      ///< printable, the camera's words for it

  /// Whether the camera does not have what was asked for.
  bool isNotSupported() const;
};

/// Unknown and damaged bodies give Code::unknown.
ResponseStatus parseResponseStatus(std::string_view body);

}  // namespace cartvo::capture
