// Requests of an RTSP client: authentication, redirections, and errors that say what to do.

#include "capture/rtsp/rtsp_client.hpp"

#include <algorithm>

namespace cartvo::capture {
namespace {

constexpr int kMaxRedirections = 3;

std::string requestText(std::string_view method, std::string_view url, const RtspClient::Headers& headers,
                        int number, const std::string& authorization) {
  std::string text;
  text.append(method).append(" ").append(url).append(" RTSP/1.0\r\n");
  text.append("CSeq: ").append(std::to_string(number)).append("\r\nUser-Agent: cartvo\r\n");
  for (const auto& [name, value] : headers)
    text.append(name).append(": ").append(value).append("\r\n");
  if (!authorization.empty()) text.append("Authorization: ").append(authorization).append("\r\n");
  return text.append("\r\n");
}

std::span<const std::uint8_t> bytesOf(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

bool isRedirection(int status) {
  return status >= 301 && status <= 308 && status != 304;
}

}  // namespace

RtspClient::RtspClient(const RtspCameraSettings& settings, const std::atomic<bool>& interrupted,
                       PacketHandler on_packet)
    : settings_(settings),
      interrupted_(interrupted),
      on_packet_(std::move(on_packet)),
      server_(parseRtspUrl(settings.url)),
      socket_(interrupted),
      authenticator_(settings.credentials, settings.basic_authentication) {}

void RtspClient::connect() {
  const auto why = socket_.connect(server_, Clock::now() + settings_.answer_timeout);
  if (interrupted_) throw RtspError(RtspError::Kind::interrupted, "interrupted");
  if (!why) return;
  throw RtspError(RtspError::Kind::unreachable, "cannot open " + camera() + ": " + *why);
}

bool RtspClient::send(std::string_view method, std::string_view url, const Headers& headers,
                      Clock::time_point deadline) {
  last_ = {std::string(method), std::string(url), headers, last_.number, false};
  return sendAgain(deadline);
}

bool RtspClient::sendAgain(Clock::time_point deadline) {
  const std::string authorization =
      authenticator_.isReady() ? authenticator_.authorization(last_.method, last_.url) : std::string();
  ++last_.number;
  return socket_.send(
      bytesOf(requestText(last_.method, last_.url, last_.headers, last_.number, authorization)), deadline);
}

RtspResponse RtspClient::request(std::string_view method, std::string& url, const Headers& headers,
                                 Clock::time_point deadline) {
  bool may_reconnect = has_answered_ && !has_session_;  // it may have ended its answer by closing
  int redirections = 0;
  send(method, url, headers, deadline);
  for (;;) {
    RtspInput input = receiveResponse(deadline);
    if (input.kind != RtspInput::Kind::message) {
      // Some cameras close the connection after each challenge.
      if (input.kind != RtspInput::Kind::closed || !may_reconnect) throw closedError(method, input);
      may_reconnect = false;
      connect();
      sendAgain(deadline);
    } else if (input.head.status == 401) {
      acceptChallenge(input.head);
      may_reconnect = true;
      sendAgain(deadline);
    } else if (isRedirection(input.head.status) && redirections++ < kMaxRedirections) {
      url = redirected(input.head);
      send(method, url, headers, deadline);
    } else {
      has_answered_ = true;
      has_session_ = has_session_ || input.head.header("session").has_value();
      return {std::move(input.head), std::move(input.body)};
    }
  }
}

/// Waits for the response to the last request; hands over packets, and answers the server's requests.
RtspInput RtspClient::receiveResponse(Clock::time_point deadline) {
  for (;;) {
    RtspInput input = socket_.receive(deadline);
    if (interrupted_) throw RtspError(RtspError::Kind::interrupted, "interrupted");
    if (input.kind == RtspInput::Kind::interleaved) {
      on_packet_(input);
    } else if (input.kind != RtspInput::Kind::message || input.head.status >= 200) {
      return input;  // requests are answered one by one; some cameras state a wrong CSeq
    } else if (input.head.status == 0) {
      answerRequest(input.head, deadline);
    }
    if (Clock::now() >= deadline) return {};
  }
}

/// Takes the challenge of a 401 response for the next attempt. Throws RtspError if the credentials were
/// refused, or if no challenge can be answered.
void RtspClient::acceptChallenge(const RtspHead& head) {
  if (settings_.credentials.user.empty())
    throw refused(camera() + " requires a user and password, and none are configured");
  std::vector<Challenge> challenges;
  for (const auto& [name, value] : head.headers) {
    if (name != "www-authenticate") continue;
    for (Challenge& challenge : parseChallenges(value))
      challenges.push_back(std::move(challenge));
  }
  const bool is_stale = std::any_of(challenges.begin(), challenges.end(),
                                    [](const Challenge& challenge) { return challenge.stale; });
  const std::string nonce = authenticator_.isReady() ? authenticator_.nonce() : std::string();
  std::string offered;
  switch (authenticator_.accept(challenges, offered)) {
    case Authenticator::Outcome::accepted:
      if (authenticator_.sendsPassword()) socket_.stopQuoting();
      break;
    case Authenticator::Outcome::basic_only:
      throw refused(
          camera() +
          " accepts only Basic authentication, which sends the password readably: switch on Digest in "
          "the camera (on Hikvision: RTSP authentication 'digest'), or, in a network that no stranger can "
          "read, set cameras.authentication: basic");
    case Authenticator::Outcome::unsupported:
      throw refused(camera() + " asks for an authentication that is not supported (" +
                    (offered.empty() ? "it names none" : offered) +
                    "); set its RTSP authentication to Digest with SHA-256 or MD5");
  }
  const bool has_new_nonce = is_stale && authenticator_.nonce() != nonce;
  if (last_.answered_challenge && !has_new_nonce) {
    throw refused(camera() + " refused the user or password (user '" + settings_.credentials.user +
                  "'); correct them, or wait if the camera has locked the account");
  }
  last_.answered_challenge = true;
}

/// Answers a request of the server: some end the session otherwise.
bool RtspClient::answerRequest(const RtspHead& head, Clock::time_point deadline) {
  const bool is_known = head.reason.starts_with("OPTIONS ") || head.reason.starts_with("GET_PARAMETER ");
  std::string text = is_known ? "RTSP/1.0 200 OK\r\n" : "RTSP/1.0 501 Not Implemented\r\n";
  if (const auto number = head.number("cseq"))
    text.append("CSeq: ").append(std::to_string(*number)).append("\r\n");
  return socket_.send(bytesOf(text.append("\r\n")), deadline);
}

bool RtspClient::takeResponse(const RtspHead& head, Clock::time_point deadline) {
  if (head.status == 0) return answerRequest(head, deadline);
  if (head.status != 401) return true;
  try {
    acceptChallenge(head);
  } catch (const RtspError&) {
    return false;
  }
  return sendAgain(deadline);
}

/// URL to which a response redirects, on the same server. Throws RtspError if it is another one.
std::string RtspClient::redirected(const RtspHead& head) const {
  std::string location(head.header("location").value_or(""));
  std::string why;
  try {
    checkRtspUrl(location);
    if (parseRtspUrl(location).hasSameServer(server_)) return location;
    why =
        "which is another server: if it is the right one, set it as the camera's url; the password is sent "
        "to the configured host and port only";
  } catch (const std::invalid_argument&) {
    why = "which is no RTSP URL";
  }
  std::string target = "an address";
  if (socket_.quotes()) target = std::string("'").append(quotedForMessage(location)).append("'");
  throw RtspError(RtspError::Kind::unreachable,
                  camera() + " redirects (" + statusText(head) + ") to " + target + ", " + why);
}

RtspError RtspClient::closedError(std::string_view method, const RtspInput& input) const {
  std::string text = camera() + " ";
  switch (input.kind) {
    case RtspInput::Kind::closed:
      text = "cannot open " + camera() + ": it closed the connection instead of answering " +
             std::string(method) + " (" + input.reason + "); is this the port of its RTSP server?";
      break;
    case RtspInput::Kind::invalid:
      text += input.reason;
      break;
    default:
      text = "no answer from " + camera() + " to " + std::string(method) + " within " +
             std::to_string(settings_.connect_timeout.count()) + " ms" +
             (has_answered_ ? " of the connection; raise cameras.connect_timeout if it is slow" : "");
  }
  return {RtspError::Kind::unreachable, text};
}

RtspError RtspClient::failure(std::string_view method, const RtspHead& head) const {
  std::string advice;
  switch (head.status) {
    case 403:
      return refused(camera() + " forbids " + std::string(method) + " (" + statusText(head) +
                     "): allow the user to watch this stream, or wait if the camera has locked the account");
    case 404:
    case 454:
      return {RtspError::Kind::unreachable,
              camera() + " has no such stream (" + statusText(head) + "); check the path of its URL"};
    case 406:
    case 461:
      advice = settings_.transport == RtspTransport::tcp
                   ? "it does not send over TCP: set cameras.transport: udp"
                   : "it does not send over UDP: set cameras.transport: tcp";
      break;
    case 453:
    case 503:
      advice =
          "it is not ready yet, has nothing more to send, or cannot serve another viewer: wait, close other "
          "viewers and recorders, or use its substream";
      break;
    default:
      advice = isRedirection(head.status) ? "it redirects again and again: check the path of its URL"
                                          : "check its URL, and whether another player shows this stream";
  }
  return {RtspError::Kind::unreachable,
          camera() + " answered " + std::string(method) + " with " + statusText(head) + "; " + advice};
}

}  // namespace cartvo::capture
