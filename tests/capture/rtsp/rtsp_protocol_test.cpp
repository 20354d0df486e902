// Parsing of RTSP messages, challenges and session descriptions, and order of RTP packets.

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/network/name_resolver.hpp"
#include "capture/rtsp/digest_authentication.hpp"
#include "capture/rtsp/rtp_packet.hpp"
#include "capture/rtsp/rtsp_message.hpp"
#include "capture/rtsp/rtsp_url.hpp"
#include "capture/rtsp/session_description.hpp"

namespace cartvo::capture {
namespace {

using testing::HasSubstr;
using testing::Not;

// RFC 7616, 3.9.1: the same request with both algorithms.
constexpr const char* kChallenges =
    "Digest realm=\"http-auth@example.org\", qop=\"auth, auth-int\", algorithm=SHA-256, "
    "nonce=\"7ypf/xlj9XXwfDPEoM4URrv/xwf94BcCAzFZH4GiTo0v\", "
    "opaque=\"FQhe/qaU925kfnzjCev0ciny7QMkPqMAFRtzCUYo5tdS\", "
    "Digest realm=\"http-auth@example.org\", qop=\"auth, auth-int\", algorithm=MD5, "
    "nonce=\"7ypf/xlj9XXwfDPEoM4URrv/xwf94BcCAzFZH4GiTo0v\", "
    "opaque=\"FQhe/qaU925kfnzjCev0ciny7QMkPqMAFRtzCUYo5tdS\"";
const Credentials kMufasa{"Mufasa", "Circle of Life"};

TEST(DigestAuthentication, ComputesExampleOfRfc7616) {
  const std::vector<Challenge> challenges = parseChallenges(kChallenges);
  ASSERT_EQ(challenges.size(), 2U);
  const auto answer = [&](const Challenge& challenge) {
    return digestAuthorization(challenge, kMufasa, "GET", "/dir/index.html",
                               "f2/wE4q74E6zIJEtWaHKaf5wv/H5QzzpXusqGemxURZJ", 1);
  };
  EXPECT_THAT(answer(challenges[0]),
              HasSubstr("response=\"753927fa0e85d155564e2e272a28d1802ca10daf4496794697cf8db5856cb6c1\""));
  EXPECT_THAT(answer(challenges[1]), HasSubstr("response=\"8ca523f5e9506fed4657c9700eebdbec\""));
  EXPECT_THAT(answer(challenges[0]), HasSubstr("algorithm=SHA-256, opaque=\"FQhe/"));
}

TEST(DigestAuthentication, ComputesExampleOfRfc2617WithoutQop) {
  // RFC 2069's form, as most cameras use it: no qop, no algorithm.
  const auto challenges = parseChallenges("Digest realm=\"a, \\\"b\\\"\", nonce=\"n\"");
  ASSERT_EQ(challenges.size(), 1U);
  EXPECT_EQ(challenges[0].realm, "a, \"b\"");
  const std::string answer = digestAuthorization(challenges[0], {"u", "p"}, "DESCRIBE", "rtsp://h/", "c", 1);
  EXPECT_THAT(answer, HasSubstr("realm=\"a, \\\"b\\\"\""));
  EXPECT_THAT(answer, Not(HasSubstr("qop")));
  EXPECT_THAT(answer, Not(HasSubstr("cnonce")));
}

TEST(DigestAuthentication, PrefersSha256InAnyOrderAndRefusesBasic) {
  std::string offered;
  for (const char* text :
       {"Digest realm=\"r\", nonce=\"a\", algorithm=MD5, Digest realm=\"r\", nonce=\"b\", algorithm=SHA-256",
        "Digest realm=\"r\", nonce=\"b\", algorithm=\"SHA-256\", Basic realm=\"r\", Digest realm=\"r\", "
        "nonce=\"a\""}) {
    Authenticator authenticator({"u", "p"}, true);
    ASSERT_EQ(authenticator.accept(parseChallenges(text), offered), Authenticator::Outcome::accepted);
    EXPECT_THAT(authenticator.authorization("PLAY", "rtsp://h/"), HasSubstr("algorithm=SHA-256"));
  }
  Authenticator careful({"u", "secret"}, false);
  EXPECT_EQ(careful.accept(parseChallenges("Basic realm=\"r\""), offered),
            Authenticator::Outcome::basic_only);
  EXPECT_EQ(careful.accept(parseChallenges("Digest nonce=\"a\", algorithm=SHA-512-256, Bearer"), offered),
            Authenticator::Outcome::unsupported);
  EXPECT_EQ(offered, "Digest SHA-512-256, Bearer");
  EXPECT_FALSE(careful.isReady());
  Authenticator trusting({"u", "secret"}, true);
  ASSERT_EQ(trusting.accept(parseChallenges("Basic realm=\"r\""), offered), Authenticator::Outcome::accepted);
  EXPECT_EQ(trusting.authorization("PLAY", "rtsp://h/"), "Basic dTpzZWNyZXQ=");
}

TEST(DigestAuthentication, KeepsHeaderInOneLine) {
  auto challenges = parseChallenges("Digest realm=\"r\", nonce=\"n\", opaque=\"o\"");
  challenges[0].nonce = "x\r\nInjected: 1";
  const std::string answer = digestAuthorization(challenges[0], {"u\n", "p"}, "PLAY", "rtsp://h/", "c", 1);
  EXPECT_EQ(answer.find_first_of("\r\n"), std::string::npos);
}

TEST(RtspMessage, ParsesResponsesAndRequests) {
  const auto head =
      parseRtspHead("RTSP/1.0 461 Unsupported\x1b[31m Transport\r\nCSEQ:  7 \r\nA: b\r\n c\r\n\r\n");
  ASSERT_TRUE(head);
  EXPECT_EQ(head->status, 461);
  EXPECT_THAT(head->reason, Not(HasSubstr("\x1b")));
  EXPECT_EQ(head->number("cseq"), 7U);
  EXPECT_EQ(head->header("a"), "b c");
  EXPECT_FALSE(head->header("b"));
  const auto request = parseRtspHead("OPTIONS rtsp://h/ RTSP/1.0\r\nCSeq: x\r\n\r\n");
  ASSERT_TRUE(request);
  EXPECT_EQ(request->status, 0);
  EXPECT_FALSE(request->number("cseq"));
  for (const char* text :
       {"HTTP/1.1 200 OK\r\n\r\n", "RTSP/1.0\r\n\r\n", "RTSP/1.0 x\r\n\r\n", "RTSP/1.0 99\r\n\r\n", ""})
    EXPECT_FALSE(parseRtspHead(text)) << text;
  const auto large = parseRtspHead("RTSP/1.0 200 OK\r\nContent-Length: 99999999999999999999999\r\n\r\n");
  EXPECT_EQ(large->number("content-length"), static_cast<std::size_t>(-1));
}

TEST(RtspUrl, TakesZonesInBothSpellings) {
  for (const char* url : {"rtsp://[FE80::64%25enP1]:99/1", "rtsp://[fe80::64%enP1]:99/1"}) {
    EXPECT_NO_THROW(checkRtspUrl(url));
    EXPECT_EQ(parseRtspUrl(url).host, "fe80::64%enP1");
    EXPECT_EQ(parseRtspUrl(url).port, "99");
    EXPECT_THAT(urlForServer(url), testing::MatchesRegex("rtsp://\\[(FE|fe)80::64\\]:99/1"));
    EXPECT_TRUE(parseRtspUrl(url).hasSameServer(parseRtspUrl("rtsp://[fe80::64]:99/2")));
  }
  EXPECT_EQ(urlForServer("rtsp://camera/a%20b?c=[d]"), "rtsp://camera/a%20b?c=[d]");
  EXPECT_THROW(checkRtspUrl("rtsp://fe80::64%eth1/1"), std::invalid_argument) << "no brackets";
}

TEST(NameResolver, TakesAddressesAndNamesWhatIsWrong) {
  const std::atomic<bool> interrupted = false;
  const auto soon = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  EXPECT_EQ(resolveName("192.0.2.1", "554", soon, interrupted).addresses.at(0).text(), "192.0.2.1");
  EXPECT_EQ(resolveName("fe80::1%lo", "554", soon, interrupted).addresses.at(0).text(), "fe80::1%lo");
  EXPECT_THAT(resolveName("fe80::1", "554", soon, interrupted).error, HasSubstr("needs the interface"));
  EXPECT_THAT(resolveName("fe80::1%none", "554", soon, interrupted).error,
              HasSubstr("no network interface of this computer"));
  EXPECT_THAT(resolveName("camera.invalid", "554", soon, interrupted).error, HasSubstr("'camera.invalid'"));
}

TEST(NameResolver, ReturnsAtTheDeadlineAndWhenInterrupted) {
  const auto past = std::chrono::steady_clock::now();
  std::atomic<bool> interrupted = false;
  EXPECT_THAT(resolveName("late.invalid", "554", past, interrupted).error,
              HasSubstr("the name 'late.invalid' was not resolved within"));
  interrupted = true;
  const auto later = past + std::chrono::hours(1);
  EXPECT_FALSE(resolveName("interrupted.invalid", "554", later, interrupted).error.empty());
}

TEST(RtspUrl, IgnoresCaseAndSplitsAddresses) {
  EXPECT_NO_THROW(checkRtspUrl("RTSP://Camera:8554/a"));
  EXPECT_TRUE(parseRtspUrl("RTSP://Camera/a").hasSameServer(parseRtspUrl("rtsp://camera:554/b?c")));
  EXPECT_FALSE(parseRtspUrl("rtsp://camera/a").hasSameServer(parseRtspUrl("rtsp://camera:555/a")));
  EXPECT_EQ(parseRtspUrl("rtsp://[fe80::1]:99/x").host, "fe80::1");
  EXPECT_EQ(parseRtspUrl("rtsp://[fe80::1]:99/x").port, "99");
  EXPECT_EQ(parseRtspUrl("rtsp://[fe80::1]/x").port, "554");
  for (const char* url : {"http://h/", "rtsp://", "rtsp:///x", "rtsp://h:0/", "rtsp://h:65536/",
                          "rtsp://h:x/", "rtsps://h/", "rtsp://u:p@h/", "rtsp://h/ x"})
    EXPECT_THROW(checkRtspUrl(url), std::invalid_argument) << url;
}

TEST(RtspUrl, ResolvesControlAttributes) {
  EXPECT_EQ(controlUrl("rtsp://h/a", "trackID=1"), "rtsp://h/a/trackID=1");
  EXPECT_EQ(controlUrl("rtsp://h/a/", "/trackID=1"), "rtsp://h/a/trackID=1");
  EXPECT_EQ(controlUrl("rtsp://h/a?b=1", "t?c=2"), "rtsp://h/a?b=1/t?c=2");
  EXPECT_EQ(controlUrl("rtsp://h/a", "*"), "rtsp://h/a");
  EXPECT_EQ(controlUrl("rtsp://h/a", ""), "rtsp://h/a");
  EXPECT_EQ(controlUrl("rtsp://h/a", "RTSP://10.0.0.1/b"), "RTSP://10.0.0.1/b");
}

TEST(SessionDescription, FindsVideoAmongOtherStreams) {
  const std::string text =
      "v=0\r\ns=x\r\na=control:rtsp://h/all/\r\n"
      "m=audio 0 RTP/AVP 0\r\na=control:audio\r\n"
      "m=application 0 RTP/AVP 107\r\na=rtpmap:107 vnd.onvif.metadata/90000\r\na=control:meta\r\n"
      "m=video 0 RTP/AVP 96 \r\na=rtpmap:96 h264/90000\r\n"
      "a=fmtp:96 packetization-mode=1; sprop-parameter-sets=Z0IAH5WoFAFuQA==,aM48gA== "
      ";x=y\r\na=control:video\r\n";
  std::string offered;
  const auto video = describedVideo(text, offered);
  ASSERT_TRUE(video);
  EXPECT_EQ(video->format.codec, VideoCodec::h264);
  EXPECT_EQ(video->payload_type, 96);
  EXPECT_EQ(video->control, "video");
  EXPECT_EQ(video->session_control, "rtsp://h/all/");
  EXPECT_EQ(video->format.parameter_sets.size(), 4U + 10U + 4U + 4U);
  EXPECT_EQ(video->format.parameter_sets[4], 0x67);
}

TEST(SessionDescription, ReadsParameterSetsHoweverTheyArePadded) {
  for (const char* padding : {"", "=", "==", "==="}) {
    std::string offered;
    const auto video = describedVideo(std::string("m=video 0 RTP/AVP 96\r\na=rtpmap:96 H264/90000\r\n"
                                                  "a=fmtp:96 sprop-parameter-sets=aM48gA==,Z0IAH5WoFAFuQA") +
                                          padding + "\r\na=control:video\r\n",
                                      offered);
    ASSERT_TRUE(video) << padding;
    EXPECT_EQ(video->format.parameter_sets.size(), 4U + 4U + 4U + 10U) << padding;
  }
}

TEST(SessionDescription, TakesEachPayloadTypeAndLineEnd) {
  for (const char* end : {"\n", "\r\n", "\r"}) {
    std::string text;
    for (const char* line :
         {"m=video 0 RTP/AVP 26 97 98", "a=rtpmap:97 H264/90000", "a=fmtp:97 x=y", "a=control:t"})
      text.append(line).append(end);
    std::string offered;
    const auto video = describedVideo(text, offered);
    ASSERT_TRUE(video);
    EXPECT_EQ(video->payload_type, 97);
    EXPECT_EQ(video->control, "t");
  }
  std::string offered;
  EXPECT_TRUE(describedVideo("m=video 0 RTP/AVP 96\na=fmtp:96 sprop-parameter-sets=aM48gA==\n", offered))
      << "no rtpmap";
}

TEST(SessionDescription, PrefersVideoWithoutEncryption) {
  const std::string encrypted = "m=video 0 RTP/SAVPF 96\r\na=rtpmap:96 H264/90000\r\na=control:secret\r\n";
  const std::string open = "m=video 0 RTP/AVP 97\r\na=rtpmap:97 H264/90000\r\na=control:open\r\n";
  std::string offered;
  EXPECT_EQ(describedVideo(encrypted + open, offered)->control, "open");
  EXPECT_FALSE(describedVideo(encrypted + open, offered)->is_encrypted);
  EXPECT_TRUE(describedVideo(encrypted, offered)->is_encrypted);
}

TEST(SessionDescription, NamesWhatIsOfferedInstead) {
  std::string offered;
  EXPECT_FALSE(
      describedVideo("m=video 0 RTP/AVP 26\r\nm=audio 0 RTP/AVP 97\r\na=rtpmap:97 opus/48000\r\n", offered));
  EXPECT_EQ(offered, "JPEG, OPUS");
  EXPECT_FALSE(describedVideo("m=\nm=video\na=rtpmap:\na=fmtp:96\n\n=\nx", offered));
}

/// RTP packet with this sequence number.
std::vector<std::uint8_t> rtp(unsigned sequence, std::uint8_t source = 1) {
  std::vector<std::uint8_t> packet = {0x80, 96, 0, 0, 0, 0, 0, 1, 0, 0, 0, source, 0x41};
  packet[2] = static_cast<std::uint8_t>(sequence >> 8);
  packet[3] = static_cast<std::uint8_t>(sequence);
  return packet;
}

/// Numbers that come out, each with '!' if packets before it are missing.
std::string sequenced(RtpSequencer& sequencer, const std::vector<unsigned>& numbers,
                      std::uint8_t source = 1) {
  static std::int64_t now_ns = 0;
  std::string text;
  for (const unsigned number : numbers) {
    const std::vector<std::uint8_t> bytes = rtp(number, source);
    sequencer.add(*parseRtpPacket(bytes), {bytes, now_ns += 1'000'000, false});
    while (const auto packet = sequencer.pop()) {
      text.append(" ").append(std::to_string(parseRtpPacket(packet->bytes)->sequence));
      if (packet->data_lost) text += '!';
    }
  }
  return text;
}

TEST(RtpSequencer, RestoresOrderDropsDuplicatesAndFindsLosses) {
  RtpSequencer udp(4, 100'000'000);
  EXPECT_EQ(sequenced(udp, {65534, 65535, 1, 0, 0, 2, 2}), " 65534 65535 0 1 2");
  EXPECT_EQ(sequenced(udp, {4, 5, 6, 7}), "") << "3 may still come";
  EXPECT_EQ(sequenced(udp, {8}), " 4! 5 6 7 8");
  EXPECT_EQ(udp.lost(), 1U);
  EXPECT_EQ(sequenced(udp, {3, 9}), " 9") << "too late";
  RtpSequencer tcp(0, 0);
  EXPECT_EQ(sequenced(tcp, {1, 2, 5, 6}), " 1 2 5! 6");
  EXPECT_EQ(tcp.lost(), 2U);
}

TEST(RtpSequencer, WaitsForAMissingPacketNoLongerThanItsPatience) {
  RtpSequencer udp(64, 3'000'000);
  EXPECT_EQ(sequenced(udp, {1, 3, 4, 5, 6, 7}), " 1 3! 4 5 6 7");
}

TEST(RtpSequencer, FollowsANewSequenceAndANewSender) {
  RtpSequencer tcp(0, 0);
  EXPECT_EQ(sequenced(tcp, {1, 2, 30000, 30001, 3, 4, 0, 1}), " 1 2 30000 30001 3 4 0 1")
      << "the order of arrival";
  EXPECT_EQ(sequenced(tcp, {7, 8}, 2), " 7 8");
  RtpSequencer udp(4, 100'000'000);
  EXPECT_EQ(sequenced(udp, {1, 2, 30000, 3}), " 1 2 3") << "one stray number";
  EXPECT_EQ(udp.leftOut(), 1U);
  EXPECT_EQ(sequenced(udp, {30000, 30001, 30002}), " 30001! 30002");
  EXPECT_EQ(sequenced(udp, {7, 8}, 2), " 7! 8");
  const std::uint64_t before = udp.leftOut();
  EXPECT_EQ(sequenced(udp, {10, 11}, 2), "") << "9 may still come";
  EXPECT_EQ(sequenced(udp, {1, 2}, 3), " 1! 2");
  EXPECT_EQ(udp.leftOut(), before + 2);
}

TEST(RtpSequencer, IgnoresGapsOverTcpThatAreAHabit) {
  RtpSequencer by_twos(0, 0);
  std::string out;
  for (unsigned i = 0; i < 40; ++i)
    out = sequenced(by_twos, {2 * i});
  EXPECT_EQ(out, " 78") << "without a loss";
  EXPECT_LT(by_twos.lost(), 12U);
  RtpSequencer lossy(0, 0);
  for (unsigned i = 0; i < 400; ++i) {
    if (i % 20 != 7) out = sequenced(lossy, {i});
    if (i % 20 == 8) {
      EXPECT_THAT(out, HasSubstr("!"));
    }
  }
  EXPECT_EQ(lossy.lost(), 20U);
}

TEST(RtpPacket, ParsesHeadersAndRefusesMalformedOnes) {
  std::vector<std::uint8_t> bytes = {
      0xb1, 0xe0, 0, 5, 0, 0, 0, 9, 1,    2,    3, 4, 0, 0, 0, 0,  // one contributor
      0,    0,    0, 1, 7, 7, 7, 7, 0x41, 0x42, 1, 2};             // extension, padding of 2
  const auto packet = parseRtpPacket(bytes);
  ASSERT_TRUE(packet);
  EXPECT_TRUE(packet->marker);
  EXPECT_EQ(packet->payload_type, 96);
  EXPECT_EQ(packet->timestamp, 9U);
  EXPECT_EQ(std::vector<std::uint8_t>(packet->payload.begin(), packet->payload.end()),
            (std::vector<std::uint8_t>{0x41, 0x42}));
  for (std::size_t size = 0; size < 24; ++size)
    EXPECT_FALSE(parseRtpPacket(std::span(bytes).first(size))) << size;
  bytes[0] = 0x40;
  EXPECT_FALSE(parseRtpPacket(bytes));
}

TEST(RtcpPacket, ReadsSenderReportsAndGoodbyes) {
  std::vector<std::uint8_t> bytes = {0x80, 200, 0, 6, 0,    0,   0, 7, 0x83, 0xaa, 0x7e, 0x81,
                                     0x80, 0,   0, 0, 0,    0,   0, 9, 0,    0,    0,    0,
                                     0,    0,   0, 0, 0x81, 203, 0, 1, 0,    0,    0,    7};
  const RtcpContent content = parseRtcp(bytes);
  ASSERT_EQ(content.reports.size(), 1U);
  EXPECT_EQ(content.reports[0].instant_us, 1'500'000);  // 1.5 s after 1970 began
  EXPECT_EQ(content.reports[0].timestamp, 9U);
  EXPECT_EQ(content.reports[0].ntp_middle, 0x7e818000U);
  EXPECT_EQ(content.ended_source, 7U);
  EXPECT_TRUE(content.is_whole);
  EXPECT_THAT(parseRtcp(std::span(bytes).first(20)).reports, testing::IsEmpty());
  for (const std::size_t size : {2, 20, 33})
    EXPECT_FALSE(parseRtcp(std::span(bytes).first(size)).is_whole) << size;
  bytes[3] = 1;  // a report without its contents
  EXPECT_FALSE(parseRtcp(std::span(bytes).first(8)).is_whole);
  EXPECT_TRUE(isRtcp(bytes));
  EXPECT_FALSE(isRtcp(rtp(1)));
  const auto report = receiverReportPacket({1, 7, 3, 70000, 5, 6});
  EXPECT_EQ(report.size() % 4, 0U);
  EXPECT_EQ(report[1], 201);
  EXPECT_EQ(report[33], 202);
}

}  // namespace
}  // namespace cartvo::capture
