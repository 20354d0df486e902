// State of a login and result of a request.
#include "capture/isapi/isapi_answers.hpp"

#include <algorithm>
#include <charconv>

#include "capture/isapi/xml_document.hpp"
#include "common/ascii_text.hpp"
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

}  // namespace cartvo::capture
