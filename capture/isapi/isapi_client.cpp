// Client of ISAPI: login, retries, errors that say what to do, and the known keys of cameras.
#include "capture/isapi/isapi_client.hpp"

#include <algorithm>
#include <charconv>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "capture/isapi/xml_document.hpp"
#include "common/ascii_text.hpp"
#include "common/atomic_file.hpp"
#include "common/input_file.hpp"
#include "common/printable_text.hpp"

namespace cartvo::capture {
namespace {

/// A number from 0 to 10^9 at the begin of a text.
std::optional<int> number(const std::optional<std::string>& text) {
  constexpr int kMax = 1'000'000'000;
  int value = 0;
  if (!text || std::from_chars(text->data(), text->data() + text->size(), value).ec != std::errc() ||
      value < 0)
    return std::nullopt;
  return std::min(value, kMax);
}

constexpr const char* kUserCheck = "/ISAPI/Security/userCheck";
constexpr int kMaxAttempts = 2;  // to challenges of one request

bool isSuccess(const HttpResponse& response) {
  return response.status >= 200 && response.status < 300;
}

std::string statusText(const HttpResponse& response) {
  const ResponseStatus status = parseResponseStatus(response.body);
  std::string text = "HTTP " + std::to_string(response.status);
  if (!status.text.empty()) text += ", " + status.text;
  if (!status.sub_code.empty()) text += ", " + status.sub_code;
  return text;
}

std::string withLoginState(std::string text, const LoginState& state) {
  const std::string known = loginStateText(state);
  return known.empty() ? text : std::move(text) + "; " + known;
}

constexpr std::uintmax_t kMaxFileBytes = 64 * 1024;

std::string nameOf(const HttpAddress& address) {
  return address.host + ":" + std::to_string(address.port);
}

}  // namespace

LoginState parseLoginState(std::string_view body) {
  LoginState state;
  const std::optional<XmlDocument> document = XmlDocument::parseIfXml(body);
  if (!document) return state;
  if (const auto lock = document->anyText("lockStatus")) state.locked = lowerCase(*lock).starts_with("lock");
  if (const auto seconds = number(document->anyText("unlockTime"))) {
    if (*seconds > 0 && !state.locked) state.locked = true;
    if (*seconds > 0 && state.isLocked()) state.unlock_after = std::chrono::seconds(*seconds);
  }
  state.attempts_left = number(document->anyText("retryLoginTime"));
  state.activated = document->anyTruth("isActivated");
  return state;
}

std::string loginStateText(const LoginState& state) {
  if (state.activated == false)
    return "the camera is not activated: give it a password in its web page or by SADP; until then it "
           "streams nothing";
  if (state.isLocked()) {
    return "the camera has locked this login" +
           (state.unlock_after ? " for another " + std::to_string(state.unlock_after->count()) + " s"
                               : std::string());
  }
  if (!state.attempts_left) return {};
  return std::to_string(*state.attempts_left) +
         (*state.attempts_left == 1 ? " attempt is left" : " attempts are left") +
         " before the camera locks the login";
}

bool ResponseStatus::isNotSupported() const {
  const std::string word = lowerCase(sub_code);
  return word == "notsupport" || word == "methodnotallowed" || word == "invalidoperation" ||
         word == "nosuchfunction";
}

ResponseStatus parseResponseStatus(std::string_view body) {
  ResponseStatus status;
  const std::optional<XmlDocument> document = XmlDocument::parseIfXml(body);
  if (!document) return status;
  const int code = number(document->anyText("statusCode")).value_or(0);
  constexpr int kLast = static_cast<int>(ResponseStatus::Code::reboot_required);
  if (code > 0 && code <= kLast) status.code = static_cast<ResponseStatus::Code>(code);
  status.sub_code = printableExcerpt(document->anyText("subStatusCode").value_or(""));
  if (lowerCase(status.sub_code) == "rebootrequired") status.code = ResponseStatus::Code::reboot_required;
  status.text = printableExcerpt(document->anyText("statusString").value_or(""));
  return status;
}

IsapiClient::IsapiClient(const IsapiSettings& settings)
    : settings_(settings),
      connection_(settings.address, settings.timeout),
      authenticator_(settings.credentials, false) {
  connection_.setKey(settings.key);
}

LoginState IsapiClient::loginState() {
  const HttpResponse response = connection_.send({.path = kUserCheck});
  return parseLoginState(response.body);
}

/// Throws if the camera would refuse any password.
void IsapiClient::checkLogin() {
  if (login_checked_) return;
  const LoginState state = loginState();
  if (state.activated == false)
    throw IsapiError(IsapiError::Kind::not_activated, camera() + ": " + loginStateText(state), state);
  if (state.isLocked()) throw lockError(state);
  login_checked_ = true;
}

IsapiError IsapiClient::lockError(const LoginState& state) const {
  return {IsapiError::Kind::login_locked,
          camera() + " accepts no login: " + loginStateText(state) +
              "; correct the password meanwhile, and wait: each attempt may lock it anew",
          state};
}

IsapiError IsapiClient::loginError(const LoginState& state) const {
  const std::string text =
      camera() + " refused the user or password (user '" + settings_.credentials.user + "')";
  return {state.isLocked() ? IsapiError::Kind::login_locked : IsapiError::Kind::login_refused,
          withLoginState(text, state) + "; correct the password before the next attempt", state};
}

/// Takes the challenge of a 401 answer. True if it says that the answered nonce was too old.
bool IsapiClient::acceptChallenge(const HttpResponse& response) {
  if (settings_.credentials.user.empty()) {
    throw IsapiError(IsapiError::Kind::login_refused,
                     camera() + " requires a user and password, and none are configured");
  }
  std::vector<Challenge> challenges;
  for (const std::string& value : response.challenges)
    for (Challenge& challenge : parseChallenges(value))
      challenges.push_back(std::move(challenge));
  std::string offered;
  if (authenticator_.accept(challenges, offered) != Authenticator::Outcome::accepted) {
    throw IsapiError(IsapiError::Kind::login_refused,
                     camera() + " offers no Digest authentication (" +
                         (offered.empty() ? "it names none" : offered) +
                         "): set its web authentication to 'digest'; Basic would send the password readably");
  }
  return std::any_of(challenges.begin(), challenges.end(),
                     [](const Challenge& challenge) { return challenge.stale; });
}

/// Ends the session: the next request asks for the lock and a challenge before the password is sent again.
void IsapiClient::forgetLogin() {
  authenticator_ = Authenticator(settings_.credentials, false);
  login_checked_ = false;
  logged_in_ = false;
}

/// Prepares the answer to a 401. `answered_nonce`: of the challenge that the request answered, nothing if it
/// answered none. `attempts`: challenges that the request has answered so far. Throws if the password is not
/// to be sent again.
void IsapiClient::answerChallenge(const HttpResponse& response,
                                  const std::optional<std::string>& answered_nonce, int attempts) {
  const LoginState state = parseLoginState(response.body);
  const bool was_accepted = logged_in_;
  if (state.isLocked() && (!answered_nonce || was_accepted)) {
    forgetLogin();
    throw lockError(state);
  }
  const bool is_stale = !state.isLocked() && acceptChallenge(response);
  if (!answered_nonce) return;
  // A nonce dies with time and with a reboot. Only of a password that was accepted before that is known.
  const bool nonce_died = (is_stale || was_accepted) && authenticator_.nonce() != *answered_nonce;
  if (nonce_died && attempts < kMaxAttempts) return;
  refusal_ = loginError(state);
  throw IsapiError(*refusal_);
}

/// One request with authentication.
HttpResponse IsapiClient::send(const HttpRequest& request) {
  constexpr int kUnauthorized = 401, kServerError = 500;
  if (refusal_) throw IsapiError(*refusal_);
  checkLogin();
  int attempts = 0;  // challenges that this request has answered
  for (;;) {
    HttpRequest authorised = request;
    std::optional<std::string> nonce;
    if (authenticator_.isReady()) {
      ++attempts;
      nonce = authenticator_.nonce();
      authorised.headers.push_back("Authorization: " +
                                   authenticator_.authorization(request.method, request.path));
    }
    HttpResponse response = connection_.send(authorised);
    if (response.status != kUnauthorized) {
      // A camera that starts or is busy has not looked at the password.
      logged_in_ = logged_in_ || (nonce && response.status < kServerError);
      return response;
    }
    answerChallenge(response, nonce, attempts);
  }
}

/// Whether the same request may succeed soon. A camera answers 500 while it starts, and later to what it does
/// not take.
bool IsapiClient::isTransient(const HttpRequest& request, const HttpResponse& response, int retry) const {
  const ResponseStatus::Code code = parseResponseStatus(response.body).code;
  if (response.status == 503 || code == ResponseStatus::Code::busy) return true;
  if (response.status != 500 || request.method != "GET") return false;
  return !answered_ || retry == 0;
}

HttpResponse IsapiClient::sendUntilNotBusy(const HttpRequest& request) {
  for (int retry = 0;; ++retry) {
    HttpResponse response = send(request);
    if (!isTransient(request, response, retry)) {
      answered_ = answered_ || isSuccess(response);
      return response;
    }
    if (retry >= settings_.retries) {
      throw IsapiError(IsapiError::Kind::busy,
                       camera() + " is busy or still starting (" + statusText(response) +
                           "): close its web page and other programs that use it, and "
                           "try again");
    }
    std::this_thread::sleep_for(settings_.retry_pause);
  }
}

IsapiError IsapiClient::failure(const HttpRequest& request, const HttpResponse& response) const {
  const ResponseStatus status = parseResponseStatus(response.body);
  const std::string text =
      camera() + " answered " + request.method + " " + request.path + " with " + statusText(response);
  if (response.status >= 300 && response.status < 400)
    return {IsapiError::Kind::invalid_answer, text + ": it redirects, probably to HTTPS: use --https"};
  const bool is_absent = response.status == 404 || response.status == 405 || response.status == 501;
  if (is_absent || status.isNotSupported()) return {IsapiError::Kind::not_supported, text};
  if (response.status == 403) {
    return {IsapiError::Kind::forbidden, text + ": the password is right, but the user '" +
                                             settings_.credentials.user +
                                             "' may not do this; give it 'Remote: Parameters Settings' in "
                                             "the camera, or use its administrator"};
  }
  if (response.status >= 400 || request.method != "GET") return {IsapiError::Kind::rejected, text};
  return {IsapiError::Kind::invalid_answer, text + ": this is no ISAPI answer; is it a Hikvision camera?"};
}

XmlDocument IsapiClient::get(const std::string& path) {
  const HttpRequest request{.path = path};
  const HttpResponse response = sendUntilNotBusy(request);
  if (!isSuccess(response)) throw failure(request, response);
  try {
    return XmlDocument::parse(response.body, camera() + ", " + path);
  } catch (const std::runtime_error& error) {
    throw IsapiError(IsapiError::Kind::invalid_answer,
                     error.what() + std::string("; is it a Hikvision camera?"));
  }
}

std::optional<XmlDocument> IsapiClient::getIfSupported(const std::string& path) {
  try {
    return get(path);
  } catch (const IsapiError& error) {
    const bool is_absent =
        error.kind() == IsapiError::Kind::not_supported || error.kind() == IsapiError::Kind::rejected;
    if (!is_absent) throw;
    return std::nullopt;
  }
}

bool IsapiClient::put(const std::string& path, const XmlDocument& document) {
  const HttpRequest request{.method = "PUT", .path = path, .body = document.toText()};
  const HttpResponse response = sendUntilNotBusy(request);
  const ResponseStatus::Code code = parseResponseStatus(response.body).code;
  const bool is_taken = code == ResponseStatus::Code::ok || code == ResponseStatus::Code::unknown ||
                        code == ResponseStatus::Code::reboot_required;
  if (!isSuccess(response) || !is_taken) throw failure(request, response);
  return code == ResponseStatus::Code::reboot_required;
}

void IsapiClient::reboot() {
  const HttpRequest request{.method = "PUT", .path = "/ISAPI/System/reboot"};
  const HttpResponse response = sendUntilNotBusy(request);
  if (!isSuccess(response)) throw failure(request, response);
  answered_ = false;
}

bool IsapiClient::answers() {
  try {
    return isSuccess(send({.path = "/ISAPI/System/deviceInfo"}));
  } catch (const HttpError& error) {
    if (error.kind() != HttpError::Kind::unreachable) throw;
    return false;
  }
}

KnownCameras::KnownCameras(std::filesystem::path file) : file_(std::move(file)) {
  std::error_code error;
  if (!std::filesystem::exists(file_, error) && !error) return;
  text_ = readInputText(file_, kMaxFileBytes);
  if (!text_.empty() && text_.back() != '\n') text_ += '\n';
  std::istringstream lines(text_);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    std::istringstream words(line);
    std::string name, key, rest;
    if (line.empty() || line.front() == '#') continue;
    if (!(words >> name >> key) || words >> rest || !key.starts_with("sha256//")) {
      throw std::runtime_error(
          file_.string() + ":" + std::to_string(number) +
          ": expected HOST:PORT sha256//KEY; remove the line, the key is then kept anew");
    }
  }
}

std::optional<std::string> KnownCameras::keyOf(const HttpAddress& address) const {
  std::istringstream lines(text_);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name, key;
    if (words >> name >> key && name == nameOf(address)) return key;
  }
  return std::nullopt;
}

void KnownCameras::add(const HttpAddress& address, const std::string& key) {
  if (text_.empty()) text_ = "# Keys of the cameras' HTTPS certificates, kept by cartvo camera --https\n";
  text_ += nameOf(address) + " " + key + "\n";
  writeFileAtomically(file_, text_);
}

}  // namespace cartvo::capture
