// Servers that refuse, redirect or answer what no camera should: what is said of them, and what they do not
// get.

#include <atomic>
#include <cstdint>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/rtsp/rtsp_camera.hpp"
#include "tests/support/capture/encoded_sequence.hpp"
#include "tests/support/capture/live_camera.hpp"
#include "tests/support/capture/scripted_camera.hpp"

namespace cartvo::capture {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::Not;

constexpr char kPassword[] = "hunter2";

/// Answer with the request's CSeq.
std::string answer(const std::string& request, const std::string& status, const std::string& headers = "") {
  const std::size_t begin = request.find("CSeq: ");
  return "RTSP/1.0 " + status + "\r\n" + request.substr(begin, request.find('\n', begin) - begin + 1) +
         headers + "\r\n";
}

/// The requests that a server got, and error and state in the camera's health.
struct Meeting {
  std::string error;
  CameraState state = CameraState::connecting;
  std::string requests;
};

/// Connects to a server that answers as `respond` says.
Meeting meet(const std::function<std::string(const std::string&)>& respond, bool basic = false) {
  Meeting meeting;
  test::CameraScript script;
  script.pictures = test::encodeSequence(VideoCodec::h264, cv::Size(160, 120), 10, 10, "");
  script.respond = [&](const std::string& request) {
    meeting.requests += request;
    return respond(request);
  };
  test::ScriptedCamera server(script);
  RtspCameraSettings settings = test::settingsFor(server.port());
  settings.credentials = {"admin", kPassword};
  settings.basic_authentication = basic;
  settings.connect_timeout = milliseconds(1500);
  settings.first_retry = settings.longest_retry = std::chrono::seconds(60);
  RtspCamera camera(settings);
  Frame frame;
  camera.read(frame, milliseconds(300));
  meeting.error = camera.health().last_error;
  meeting.state = camera.health().state;
  return meeting;
}

/// Answers requests of one method so.
auto answering(const std::string& method, const std::string& status, const std::string& headers = "") {
  return [=](const std::string& request) {
    return request.starts_with(method) ? answer(request, status, headers) : std::string();
  };
}

TEST(RtspServer, GetsNoPasswordByBasicUnlessAllowed) {
  const auto challenge = answering("DESCRIBE", "401 Unauthorized", "WWW-Authenticate: Basic realm=\"x\"\r\n");
  const Meeting refused = meet(challenge);
  EXPECT_EQ(refused.state, CameraState::refused);
  EXPECT_THAT(refused.error, HasSubstr("accepts only Basic authentication"));
  EXPECT_THAT(refused.error, HasSubstr("cameras.authentication: basic"));
  EXPECT_THAT(refused.requests, Not(HasSubstr("Authorization")));
  EXPECT_THAT(meet(challenge, true).requests, HasSubstr("Authorization: Basic YWRtaW46aHVudGVyMg=="));
}

TEST(RtspServer, IsNotQuotedAfterItGotTheReadablePassword) {
  const char* const kEncoded = "YWRtaW46aHVudGVyMg==";
  const auto repeating = [&](const std::string& status, const std::string& location) {
    return meet(
        [&](const std::string& request) {
          if (!request.starts_with("DESCRIBE")) return std::string();
          if (request.find("Authorization") != std::string::npos) return answer(request, status, location);
          return answer(request, "401 Unauthorized", "WWW-Authenticate: Basic realm=\"x\"\r\n");
        },
        true);
  };
  const std::string repeated(kEncoded);
  const Meeting failed = repeating("451 Basic " + repeated, "");
  EXPECT_THAT(failed.error, HasSubstr("answered DESCRIBE with 451;"));
  const Meeting redirected = repeating("302 " + repeated, "Location: rtsp://192.0.2.9/" + repeated + "\r\n");
  EXPECT_THAT(redirected.error, HasSubstr("redirects (302) to an address, which is another server"));
  EXPECT_THAT(failed.error + redirected.error, Not(HasSubstr(kEncoded)));
}

TEST(RtspServer, CannotTurnDigestIntoBasic) {
  int count = 0;
  const Meeting meeting = meet([&](const std::string& request) {
    if (!request.starts_with("DESCRIBE")) return std::string();
    return answer(request, "401 Unauthorized",
                  count++ == 0 ? "WWW-Authenticate: Digest realm=\"x\", nonce=\"1\"\r\n"
                               : "WWW-Authenticate: Basic realm=\"x\"\r\n");
  });
  EXPECT_EQ(meeting.state, CameraState::refused);
  EXPECT_THAT(meeting.requests, Not(HasSubstr("Authorization: Basic")));
  EXPECT_THAT(meeting.error, Not(HasSubstr(kPassword)));
}

TEST(RtspServer, CannotRedirectToAnotherHost) {
  const Meeting meeting =
      meet(answering("DESCRIBE", "302 Moved", "Location: rtsp://192.0.2.9/else\x1b[31m\r\n"));
  EXPECT_THAT(meeting.error, HasSubstr("redirects (302 Moved) to"));
  EXPECT_THAT(meeting.error, HasSubstr("192.0.2.9"));
  EXPECT_THAT(meeting.error, Not(HasSubstr("\x1b")));
}

TEST(RtspServer, MayRedirectToAnotherPathThreeTimes) {
  int redirections = 0;
  const Meeting meeting = meet([&](const std::string& request) {
    if (!request.starts_with("DESCRIBE")) return std::string();
    ++redirections;
    const std::size_t host = request.find("rtsp://");
    const std::string base = request.substr(host, request.find('/', host + 7) - host);
    return answer(request, "301 Moved", "Location: " + base + "/again\r\n");
  });
  EXPECT_EQ(redirections, 4);
  EXPECT_THAT(meeting.error, HasSubstr("redirects again and again"));
}

TEST(RtspServer, RefusalsSayWhatToDo) {
  const struct {
    const char* method;
    const char* status;
    const char* text;
  } cases[] = {{"SETUP", "461 Unsupported Transport", "set cameras.transport: udp"},
               {"SETUP", "406 no TCP", "answered SETUP with 406 no TCP; it does not send over TCP"},
               {"SETUP", "453 Not Enough Bandwidth", "close other viewers"},
               {"DESCRIBE", "503 Service Unavailable", "not ready yet, has nothing more to send, or"},
               {"DESCRIBE", "404 Not Found", "has no such stream (404 Not Found); check the path of its URL"},
               {"PLAY", "500 Oops", "answered PLAY with 500 Oops"},
               {"DESCRIBE", "403 Forbidden", "allow the user to watch this stream"}};
  for (const auto& fault : cases)
    EXPECT_THAT(meet(answering(fault.method, fault.status)).error, HasSubstr(fault.text)) << fault.status;
}

TEST(RtspServer, AnswersAreBounded) {
  const Meeting body = meet(answering("DESCRIBE", "200 OK", "Content-Length: 1000000000\r\n"));
  EXPECT_THAT(body.error, HasSubstr("announces an answer of 1000000000 bytes; at most 65536 are accepted"));
  const Meeting headers = meet([](const std::string&) {
    std::string endless = "RTSP/1.0 200 OK\r\n";
    while (endless.size() < 100'000)
      endless += "A: b\r\n";
    return endless;
  });
  EXPECT_THAT(headers.error, HasSubstr("sent more than 16384 bytes of headers"));
}

TEST(RtspServer, OtherProtocolsAreNamed) {
  EXPECT_THAT(meet([](const std::string&) { return "HTTP/1.1 400 Bad Request\r\n\r\n"; }).error,
              HasSubstr("answered by HTTP (HTTP/1.1 400 Bad Request): this is a web server's port"));
  EXPECT_THAT(meet([](const std::string&) { return "220 \x01\x02 mail ready\r\n"; }).error,
              HasSubstr("sent what is not RTSP: '220 ?? mail ready'"));
  EXPECT_THAT(meet([](const std::string&) { return "\x15\x03\x01 alert"; }).error,
              HasSubstr("answered by TLS: this is the port of encrypted streams"));
}

/// Answers DESCRIBE with this description.
auto describing(const std::string& body) {
  return [body](const std::string& request) {
    return request.starts_with("DESCRIBE")
               ? answer(request, "200 OK", "Content-Length: " + std::to_string(body.size()) + "\r\n") + body
               : std::string();
  };
}

TEST(RtspServer, StreamsThatAreNotReadAreNamed) {
  EXPECT_THAT(meet(describing("m=video 0 RTP/AVP 26\r\na=control:x\r\n")).error,
              HasSubstr("sends no H.264 or H.265 video (it offers JPEG); set its stream to H.264"));
  EXPECT_THAT(meet(describing("")).error, HasSubstr("describes no stream at all; check the path of its URL"));
  EXPECT_THAT(meet(answering("SETUP", "200 OK", "Transport: RTP/AVP;multicast;port=5000-5001\r\n")).error,
              HasSubstr("switch multicast off in the camera"));
}

TEST(RtspServer, EncryptionIsNamed) {
  const Meeting meeting =
      meet(describing("m=video 0 RTP/SAVP 96\r\na=rtpmap:96 H264/90000\r\na=control:x\r\n"));
  EXPECT_THAT(meeting.error, HasSubstr("encrypts its video (SRTP, the profile RTP/SAVP)"));
  EXPECT_THAT(meeting.error, HasSubstr("switch SRTP off in the camera"));
  EXPECT_THAT(meeting.requests, Not(HasSubstr("SETUP")));
}

/// Whether a picture comes from a camera that answers SETUP with this Transport header and sends on
/// `channel`.
bool deliversOnChannel(const std::string& transport, std::uint8_t channel) {
  test::CameraScript script;
  script.pictures = test::encodeSequence(VideoCodec::h264, cv::Size(160, 120), 10, 10, "");
  script.channel = channel;
  script.respond = answering("SETUP", "200 OK", "Session: 1\r\nTransport: " + transport + "\r\n");
  test::ScriptedCamera server(script);
  RtspCamera camera(test::settingsFor(server.port()));
  Frame frame;
  return camera.read(frame, std::chrono::seconds(20)) == ReadOutcome::frame;
}

TEST(RtspServer, ChoosesItsChannels) {
  EXPECT_TRUE(deliversOnChannel("RTP/AVP/TCP;unicast;interleaved=4-5", 4));
  EXPECT_TRUE(deliversOnChannel("RTP/AVP/TCP; unicast; Interleaved = 4 - 5 ; mode=play", 4));
  EXPECT_TRUE(deliversOnChannel("RTP/AVP/TCP;unicast", 0));
  // Some send on other channels than they answer.
  EXPECT_TRUE(deliversOnChannel("RTP/AVP/TCP;unicast;interleaved=0-1", 2));
  EXPECT_TRUE(deliversOnChannel("RTP/AVP/TCP;unicast;interleaved=2-3", 0));
}

}  // namespace
}  // namespace cartvo::capture
