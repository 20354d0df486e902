// Fuzz target for what an RTSP server sends: messages, challenges, session descriptions, URLs, RTP and RTCP.

#include "capture/rtsp/digest_authentication.hpp"
#include "capture/rtsp/rtp_packet.hpp"
#include "capture/rtsp/rtsp_message.hpp"
#include "capture/rtsp/rtsp_url.hpp"
#include "capture/rtsp/session_description.hpp"
#include "common/printable_text.hpp"
#include "tests/fuzz/fuzzing.hpp"

using namespace cartvo;

namespace {

// The answer to a Digest challenge for a password, without the value of `response`.
std::string answerWithoutResponse(const capture::Challenge& challenge, const std::string& password) {
  static const std::string kResponse = "rtsp://host/\", response=\"";  // a quote in a value is escaped
  std::string answer =
      capture::digestAuthorization(challenge, {"user", password}, "PLAY", "rtsp://host/", "c", 1);
  const std::size_t begin = answer.find(kResponse) + kResponse.size();
  return answer.erase(begin, answer.find('"', begin) - begin);
}

void parseText(const std::string& text) {
  fuzz::require(isPrintable(capture::quotedForMessage(text)), "text for messages is printable");
  if (const auto head = capture::parseRtspHead(text)) {
    fuzz::require(isPrintable(head->reason), "a reason is printable");
    head->number("content-length");
  }
  std::string offered;
  for (const capture::Challenge& challenge : capture::parseChallenges(text)) {
    capture::Authenticator authenticator({"user", "password"}, true);
    if (authenticator.accept({challenge}, offered) != capture::Authenticator::Outcome::accepted) continue;
    const std::string answer = authenticator.authorization("PLAY", "rtsp://host/");
    fuzz::require(answer.find_first_of("\r\n") == std::string::npos, "a header is one line");
    if (challenge.scheme == capture::Challenge::Scheme::digest)
      fuzz::require(answerWithoutResponse(challenge, "password") == answerWithoutResponse(challenge, "other"),
                    "only the response depends on the password");
  }
  if (const auto video = capture::describedVideo(text, offered))
    capture::controlUrl("rtsp://host/", video->control);
  fuzz::require(isPrintable(offered), "encodings are printable");
  try {
    capture::checkRtspUrl(text);
    fuzz::require(!capture::parseRtspUrl(text).host.empty(), "an accepted URL has a host");
  } catch (const std::invalid_argument&) {
  }
}

void parsePackets(fuzz::Bytes bytes) {
  capture::RtpSequencer sequencer(bytes.readByte() % 8, 10);
  std::int64_t now_ns = 0;
  while (!bytes.empty()) {
    const auto piece = bytes.readSpan(bytes.readByte());
    capture::parseRtcp(piece);
    const auto packet = capture::parseRtpPacket(piece);
    if (!packet) continue;
    fuzz::require(packet->payload.size() + 12 <= piece.size(), "a payload lies in its packet");
    sequencer.add(*packet, {{piece.begin(), piece.end()}, ++now_ns, false});
    while (sequencer.pop())
      continue;
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  parseText(std::string(reinterpret_cast<const char*>(data), size));
  parsePackets(fuzz::Bytes(data, size));
  return 0;
}
