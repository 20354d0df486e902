// Checks of an IP camera.
#include "tools/doctor/cameras/camera_checks.hpp"

#include <stdexcept>

#include <fmt/format.h>

#include "capture/isapi/isapi_client.hpp"
#include "capture/rtsp/rtsp_socket.hpp"
#include "capture/rtsp/rtsp_url.hpp"
#include "tools/camera/camera_access.hpp"
#include "tools/camera/settings_check.hpp"

namespace cartvo::doctor {
namespace {

constexpr const char* kByHand =
    "check the settings on the camera's web page, as /usr/share/doc/cartvo/cameras.md lists them";

void addLoginError(const capture::IsapiError& error, CameraAnswer& answer, FindingList& findings) {
  using Kind = capture::IsapiError::Kind;
  switch (error.kind()) {
    case Kind::login_refused:
    case Kind::login_locked:
    case Kind::not_activated:
      answer.is_refused = true;
      findings.add("login", Verdict::broken,
                   {error.what(), "the camera accepts user and password",
                    error.kind() == Kind::not_activated
                        ? "set a password on the camera's web page"
                        : "correct username and the password file; wait until a lock ends, or switch the "
                          "camera off and on"});
      return;
    case Kind::forbidden:
      findings.add("settings", Verdict::look_at,
                   {error.what(), "a user who may read the settings",
                    "permit it to the user, or use the "
                    "camera's administrator"});
      return;
    default:
      findings.add("settings", Verdict::not_checked, {error.what(), "", kByHand});
  }
}

/// Reports the state of the login, which is asked without a password.
void askLoginState(capture::IsapiClient& client, const std::string& reason, CameraAnswer& answer,
                   FindingList& findings) {
  const capture::LoginState state = client.loginState();
  answer.is_refused = state.isLocked();
  const std::string text = capture::loginStateText(state);
  findings.add("login", state.isLocked() ? Verdict::broken : Verdict::not_checked,
               {reason + (text.empty() ? "" : "; " + text), "", "correct username and the password file"});
}

void readSettings(CameraAccess& access, const daemon::CameraConfiguration& camera, CameraAnswer& answer,
                  FindingList& findings) {
  answer.documents = readCamera(*access.client, access.channels);
  const CameraIdentity& identity = answer.documents->identity;
  findings.add("login", Verdict::ok,
               {camera.username.empty() ? "no user name is needed"
                                        : fmt::format("user '{}' is accepted", camera.username)});
  findings.add("model", Verdict::ok,
               {fmt::format("{}, serial number {}, firmware {}", identity.model, identity.serial_number,
                            identity.firmware)});
}

void addSettingFinding(const cartvo::Finding& finding, FindingList& findings) {
  const Setting& setting = finding.setting;
  const std::string subject = "setting " + setting.name;
  const std::string expected = fmt::format("{}: {}", wantedText(setting), setting.reason);
  const std::string apply = "cartvo camera apply " + setting.name;
  switch (finding.verdict) {
    case cartvo::Verdict::wrong:
      findings.add(subject, Verdict::look_at, {finding.value, expected, apply});
      break;
    case cartvo::Verdict::unlike:
      findings.add(subject, Verdict::look_at,
                   {finding.value, "the same on both cameras: " + setting.reason, apply});
      break;
    case cartvo::Verdict::unknown:
      findings.add(subject, Verdict::look_at,
                   {"the camera does not report it", expected, "look at it on the camera's web page"});
      break;
    default:
      break;
  }
}

void addSettings(const std::vector<cartvo::Finding>& settings, FindingList& findings) {
  std::size_t good = 0;
  for (const cartvo::Finding& finding : settings) {
    if (finding.verdict == cartvo::Verdict::good) ++good;
    addSettingFinding(finding, findings);
  }
  findings.add("other settings", Verdict::ok, {fmt::format("{} are as odometry needs them", good)});
}

}  // namespace

bool checkAddress(const daemon::Configuration& configuration, const daemon::CameraConfiguration& camera,
                  const std::atomic<bool>& interrupted, FindingList& findings) {
  capture::RtspSocket socket(interrupted);
  const std::optional<std::string> error = socket.connect(
      capture::parseRtspUrl(camera.url), capture::RtspSocket::Clock::now() + configuration.answer_timeout);
  if (interrupted) return false;
  findings.add("address", okIf(!error, Verdict::broken),
               {capture::rtspHost(camera.url) + (error ? ": " + *error : " answers"),
                fmt::format("an answer within {} ms", configuration.answer_timeout.count()),
                "see that the camera has power and its cable; ping the address; correct the url of the "
                "configuration"});
  return !error;
}

void askSettings(const daemon::Configuration& configuration, const CameraQuestion& question,
                 const std::atomic<bool>& interrupted, CameraAnswer& answer, FindingList& findings) {
  const daemon::CameraConfiguration& camera =
      question.access.side == "left" ? configuration.left : configuration.right;
  try {
    if (question.login != LoginPermission::allowed) {
      capture::IsapiClient client(withoutLogin(camera, question.access));
      client.setInterruption(interrupted);
      return askLoginState(client,
                           question.login == LoginPermission::no_password
                               ? "the password cannot be read"
                               : "cartvod was refused, so that no password was sent",
                           answer, findings);
    }
    std::vector<CameraAccess> accesses = openCameras(configuration, question.access);
    accesses.front().client->setInterruption(interrupted);
    readSettings(accesses.front(), camera, answer, findings);
  } catch (const capture::IsapiError& error) {
    // Without a user name no password was sent, and the stream may need none.
    if (camera.username.empty())
      return findings.add("settings", Verdict::not_checked, {error.what(), "", kByHand});
    addLoginError(error, answer, findings);
  } catch (const capture::HttpError& error) {
    if (interrupted) return;
    if (error.kind() == capture::HttpError::Kind::wrong_key) {
      return findings.add(
          "settings", Verdict::broken,
          {error.what(), "the key that this camera had at the first time",
           "was the camera replaced or reset? Then remove its line from the file known-cameras"});
    }
    findings.add(
        "settings", Verdict::not_checked,
        {error.what(), "",
         (question.access.https ? "" : "if it serves only HTTPS: --https; else ") + std::string(kByHand)});
  } catch (const std::runtime_error& error) {  // of the file of known cameras
    findings.add("settings", Verdict::not_checked,
                 {error.what(), "", "run it as root, or see --known-cameras"});
  }
}

void checkSettings(const std::array<const CameraDocuments*, 2>& cameras, const OdometryNeeds& needs,
                   std::array<FindingList*, 3> findings) {
  const auto settings = checkCameras(cameras, needs);
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    if (cameras[i] != nullptr) addSettings(settings[i], *findings[i]);
  }
  if (cameras[0] == nullptr || cameras[1] == nullptr) return;
  const Verdict verdict = areSameCamera(cameras) ? Verdict::broken : Verdict::look_at;
  for (const std::string& difference : compareCameras(cameras))
    findings[2]->add("cameras", verdict,
                     {difference, "two cameras of one model with one firmware",
                      "give cameras.left.url and cameras.right.url two cameras of one model, and install one "
                      "firmware on both"});
}

}  // namespace cartvo::doctor
