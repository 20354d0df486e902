#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "capture/isapi/http_connection.hpp"
#include "capture/isapi/xml_document.hpp"
#include "capture/network/credentials.hpp"
#include "capture/rtsp/digest_authentication.hpp"

// Client of ISAPI, the HTTP interface of Hikvision cameras.
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

struct IsapiSettings {
  HttpAddress address;
  std::string key;  ///< of the camera's certificate, see HttpConnection::setKey; only with TLS
  Credentials credentials;
  std::chrono::milliseconds timeout{5000};  ///< of one request

  // A camera that is busy or starts is asked again.
  int retries = 5;
  std::chrono::milliseconds retry_pause{1000};
};

/// The camera answered, but not as wished. The text names the camera, what it answered and what to do; it
/// never contains the password.
class IsapiError : public std::runtime_error {
 public:
  enum class Kind : std::uint8_t {
    login_refused,   ///< wrong user or password, see `login`
    login_locked,    ///< too many wrong passwords, see `login`
    not_activated,   ///< the camera has no password yet
    forbidden,       ///< the user may not do that
    not_supported,   ///< the camera does not have what was asked for
    rejected,        ///< the camera does not take the document
    busy,            ///< still, after the retries
    invalid_answer,  ///< no ISAPI
  };
  IsapiError(Kind kind, const std::string& what, LoginState login = {})
      : std::runtime_error(what), kind_(kind), login_(login) {}
  Kind kind() const { return kind_; }
  const LoginState& login() const { return login_; }

 private:
  Kind kind_;
  LoginState login_;
};

/// One camera's ISAPI. One request at a time, with Digest authentication only. Not thread-safe.
///
/// Before the first password is sent, the camera is asked whether it has locked the login, and no challenge
/// is answered that states a lock. A request answers a second challenge only where the camera says that the
/// nonce was too old, or has accepted the password before. After a refused password all requests throw that
/// error again and send nothing: correct the password and make another client.
class IsapiClient {
 public:
  explicit IsapiClient(const IsapiSettings& settings);

  /// As HttpConnection::setInterruption.
  void setInterruption(const std::atomic<bool>& interrupted) { connection_.setInterruption(interrupted); }

  /// State of the login, asked without a password. Empty where the camera does not tell. Throws HttpError.
  LoginState loginState();

  /// The document at a path, for example "/ISAPI/System/time". Throws IsapiError and HttpError.
  XmlDocument get(const std::string& path);

  /// As `get`; nothing if the camera does not have it.
  std::optional<XmlDocument> getIfSupported(const std::string& path);

  /// Writes a document. True if the camera wants a reboot before it takes effect. Throws IsapiError and
  /// HttpError.
  bool put(const std::string& path, const XmlDocument& document);

  /// Reboots the camera. Throws IsapiError and HttpError.
  void reboot();

  /// Whether the camera answers a request with success now, asked once. Throws IsapiError if it refuses the
  /// login, and HttpError if it has another key.
  bool answers();

  const HttpAddress& address() const { return connection_.address(); }

 private:
  HttpResponse send(const HttpRequest& request);
  HttpResponse sendUntilNotBusy(const HttpRequest& request);
  bool isTransient(const HttpRequest& request, const HttpResponse& response, int retry) const;
  void checkLogin();
  bool acceptChallenge(const HttpResponse& response);
  void answerChallenge(const HttpResponse& response, const std::optional<std::string>& answered_nonce,
                       int attempts);
  void forgetLogin();
  IsapiError lockError(const LoginState& state) const;
  IsapiError loginError(const LoginState& state) const;
  IsapiError failure(const HttpRequest& request, const HttpResponse& response) const;
  std::string camera() const { return "the camera at " + connection_.address().url(); }

  IsapiSettings settings_;
  HttpConnection connection_;
  Authenticator authenticator_;
  bool login_checked_ = false;
  std::optional<IsapiError> refusal_;  ///< of the password
  bool logged_in_ = false;             ///< the camera has accepted the password
  bool answered_ = false;              ///< the camera has answered a request with success since it started
};

/// File with the keys of cameras that were met over HTTPS, one line "HOST:PORT sha256//BASE64" each. Cameras
/// sign their certificates themselves, so that the key of the first meeting is kept and required from then
/// on.
class KnownCameras {
 public:
  /// Reads the file; a missing one is empty. Throws std::runtime_error naming file and line.
  explicit KnownCameras(std::filesystem::path file);

  std::optional<std::string> keyOf(const HttpAddress& address) const;

  /// Adds a camera and writes the file. Throws as writeFileAtomically does.
  void add(const HttpAddress& address, const std::string& key);

  const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path file_;
  std::string text_;
};

}  // namespace cartvo::capture
