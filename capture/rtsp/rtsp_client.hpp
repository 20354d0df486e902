#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "capture/rtsp/digest_authentication.hpp"
#include "capture/rtsp/rtsp_camera.hpp"
#include "capture/rtsp/rtsp_message.hpp"
#include "capture/rtsp/rtsp_socket.hpp"

// Requests of an RTSP client (RFC 2326). Internal to RtspSession.

namespace cartvo::capture {

/// Error while opening a connection. The text names the camera, who answered what, and what to do; it never
/// contains the password.
class RtspError : public std::runtime_error {
 public:
  enum class Kind : std::uint8_t { unreachable, refused, interrupted };
  RtspError(Kind kind, const std::string& what) : std::runtime_error(what), kind_(kind) {}
  Kind kind() const { return kind_; }

 private:
  Kind kind_;
};

/// Sends requests to one camera and receives their responses, with authentication and redirections.
/// Credentials go to the configured host and port only, whatever the server asks for.
class RtspClient {
 public:
  using Clock = std::chrono::steady_clock;
  using Headers = std::vector<std::pair<std::string, std::string>>;
  /// Receives the packets that arrive while a response is waited for.
  using PacketHandler = std::function<void(const RtspInput&)>;

  /// `settings` and `interrupted` must outlive the client.
  RtspClient(const RtspCameraSettings& settings, const std::atomic<bool>& interrupted,
             PacketHandler on_packet);

  /// Connects within `settings.answer_timeout`. Throws RtspError.
  void connect();

  /// Sends a request and waits for its response. Answers challenges; follows redirections within the server,
  /// which change `url`. Returns responses of any other status. Throws RtspError if none comes until the
  /// deadline, if the password is refused, or if the server redirects elsewhere.
  RtspResponse request(std::string_view method, std::string& url, const Headers& headers,
                       Clock::time_point deadline);

  /// Sends a request without waiting for the response: hand over to `takeResponse` the messages that are
  /// received later. False if the connection failed.
  bool send(std::string_view method, std::string_view url, const Headers& headers,
            Clock::time_point deadline);

  /// Takes a message that was received outside of `request`. Answers a challenge by sending the last request
  /// again, and requests of the server. False if the server refuses it.
  bool takeResponse(const RtspHead& head, Clock::time_point deadline);

  /// Error for a response that is no success, with what to do about it.
  RtspError failure(std::string_view method, const RtspHead& head) const;

  RtspSocket& socket() { return socket_; }

 private:
  struct Sent {
    std::string method, url;
    Headers headers;
    int number = 0;                   ///< CSeq
    bool answered_challenge = false;  ///< it was sent again for a challenge
  };

  bool sendAgain(Clock::time_point deadline);
  RtspInput receiveResponse(Clock::time_point deadline);
  bool answerRequest(const RtspHead& head, Clock::time_point deadline);
  void acceptChallenge(const RtspHead& head);
  std::string redirected(const RtspHead& head) const;
  RtspError closedError(std::string_view method, const RtspInput& input) const;
  RtspError refused(const std::string& text) const { return {RtspError::Kind::refused, text}; }
  std::string camera() const { return "the camera at " + server_.authority; }

  const RtspCameraSettings& settings_;
  const std::atomic<bool>& interrupted_;
  PacketHandler on_packet_;
  RtspUrl server_;
  RtspSocket socket_;
  Authenticator authenticator_;
  Sent last_;
  bool has_answered_ = false;  ///< the server has answered a request
  bool has_session_ = false;   ///< of the connection, which must not be lost any more
};

}  // namespace cartvo::capture
