// RTSP connection: set-up, RTP packets in order, keep-alive and receiver reports.

#include "capture/rtsp/rtsp_session.hpp"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <random>
#include <system_error>

#include "capture/network/udp_ports.hpp"
#include "capture/rtsp/rtp_packet.hpp"
#include "capture/rtsp/rtsp_client.hpp"
#include "capture/rtsp/session_description.hpp"
#include "common/ascii_text.hpp"

namespace cartvo::capture {
namespace {

using Clock = RtspSession::Clock;
using Remark = StreamRemarks::Kind;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr milliseconds kTeardownTimeout{200};  ///< for sending TEARDOWN, without its response
constexpr seconds kDefaultSessionTimeout{60};  ///< RFC 2326, 12.37
constexpr seconds kMaxSessionTimeout{3600};
constexpr seconds kReportInterval{5};                  ///< of receiver reports (RFC 3550, 6.2)
constexpr std::size_t kUdpWindow = 64;                 ///< packets
constexpr std::int64_t kUdpPatience_ns = 100'000'000;  ///< for a packet that others have overtaken
constexpr int kMaxUdpBatch = 64;
constexpr int kMaxPacketsElsewhere = 20;  ///< until the stream's channel or payload type is changed
constexpr std::int64_t kMaxReportDistance =
    60 * 90000;  ///< RTP time between another source's report and a picture

/// Base of the control URLs: as the answer to DESCRIBE states it, if that is a whole URL, else the request's.
std::string baseUrl(const RtspHead& head, const std::string& request) {
  for (const std::string_view name : {"content-base", "content-location"}) {
    std::string base(head.header(name).value_or(""));
    if (lowerCase(base).starts_with("rtsp://")) return base;
  }
  return request;
}

}  // namespace

struct RtspSession::Connection {
  Connection(const RtspCameraSettings& camera_settings, const std::atomic<bool>& stop)
      : settings(camera_settings),
        interrupted(stop),
        client(camera_settings, stop, [this](const RtspInput& input) { takeInterleaved(input); }),
        url(urlForServer(camera_settings.url)),
        sequencer(isUdp() ? kUdpWindow : 0, kUdpPatience_ns),
        receiver(std::random_device{}()) {}

  bool isUdp() const { return settings.transport == RtspTransport::udp; }

  void open();
  void describe();
  void setUp();
  void requireSuccess(std::string_view method, const RtspHead& head) const;
  [[noreturn]] void fail(const std::string& what) const {
    throw RtspError(RtspError::Kind::unreachable, "the camera at " + rtspHost(settings.url) + " " + what);
  }
  void takeInterleaved(const RtspInput& input);
  void takeRtp(std::span<const std::uint8_t> bytes, std::int64_t arrival_ns);
  void takeRtcp(std::span<const std::uint8_t> bytes);
  void takeReport(SenderReport one);
  void receiveDatagrams();
  std::optional<Outcome> receiveInput(Clock::time_point deadline);
  bool keepAlive();
  void sendReceiverReport();
  RtspClient::Headers sessionHeaders() const {
    return session.empty() ? RtspClient::Headers{} : RtspClient::Headers{{"Session", session}};
  }
  bool next(StreamFragment& fragment);

  const RtspCameraSettings& settings;
  const std::atomic<bool>& interrupted;
  Clock::time_point deadline{};  ///< of the set-up
  RtspClient client;
  std::string url;          ///< of the presentation
  std::string control_url;  ///< for PLAY and what follows
  std::string stream_url;   ///< for SETUP
  StreamFormat format;
  int payload_type = 0;
  std::unique_ptr<UdpPorts> udp;
  int rtp_channel = 0;
  int packets_elsewhere = 0;  ///< of the stream on other channels, before the first on rtp_channel
  std::string session;
  std::string keep_alive_method = "OPTIONS";
  Clock::duration keep_alive_interval{};
  Clock::time_point next_keep_alive{};
  Clock::time_point next_report{};
  RtpSequencer sequencer;
  std::uint32_t receiver;  ///< SSRC of the receiver reports
  std::optional<std::uint32_t> source;
  std::uint32_t newest_timestamp = 0;
  int packets_of_other_type = 0;  ///< in a row, before the first of the stream
  int other_type = 0;
  bool has_own_reports = false;  ///< a report named the packets' source
  StreamRemarks remarks;
  std::optional<SenderReport> report;
  Clock::time_point report_arrival{};
  std::optional<std::int64_t> last_timestamp;  ///< unwrapped
  SequencedPacket current;
  bool ended = false;  ///< by the sender's RTCP BYE
  std::string reason;
};

RtspSession::RtspSession(const RtspCameraSettings& settings, const std::atomic<bool>& interrupted)
    : connection_(std::make_unique<Connection>(settings, interrupted)) {
  connection_->open();
}

RtspSession::~RtspSession() {
  Connection& self = *connection_;
  if (self.control_url.empty()) return;  // not connected
  self.client.send("TEARDOWN", self.control_url, self.sessionHeaders(), Clock::now() + kTeardownTimeout);
}

const StreamFormat& RtspSession::format() const {
  return connection_->format;
}

StreamRemarks& RtspSession::remarks() {
  return connection_->remarks;
}

const std::string& RtspSession::reason() const {
  return connection_->reason;
}

void RtspSession::Connection::requireSuccess(std::string_view method, const RtspHead& head) const {
  if (head.status < 200 || head.status >= 300) throw client.failure(method, head);
}

void RtspSession::Connection::open() {
  client.connect();
  deadline = Clock::now() + settings.connect_timeout;
  const RtspResponse options = client.request("OPTIONS", url, {}, deadline);
  if (options.head.header("public").value_or("").find("GET_PARAMETER") != std::string_view::npos)
    keep_alive_method = "GET_PARAMETER";
  describe();
  setUp();
  RtspClient::Headers headers = sessionHeaders();
  headers.emplace_back("Range", "npt=0.000-");
  RtspResponse play = client.request("PLAY", control_url, headers, deadline);
  constexpr int kInvalidRange = 457;
  if (play.head.status == kInvalidRange)
    play = client.request("PLAY", control_url, sessionHeaders(), deadline);
  requireSuccess("PLAY", play.head);
  next_keep_alive = Clock::now() + keep_alive_interval;
  next_report = Clock::now() + kReportInterval;
}

void RtspSession::Connection::describe() {
  const RtspResponse response = client.request("DESCRIBE", url, {{"Accept", "application/sdp"}}, deadline);
  requireSuccess("DESCRIBE", response.head);
  std::string offered;
  const std::optional<VideoDescription> video = describedVideo(response.body, offered);
  if (!video && response.body.empty())
    fail("describes no stream at all; check the path of its URL, and restart it");
  if (!video) {
    fail("sends no H.264 or H.265 video" + (offered.empty() ? "" : " (it offers " + offered + ")") +
         "; set its stream to H.264");
  }
  if (video->is_encrypted) {
    fail(
        "encrypts its video (SRTP, the profile RTP/SAVP), which is not supported; switch SRTP off in the "
        "camera");
  }
  format = video->format;
  payload_type = video->payload_type;
  const std::string base = baseUrl(response.head, url);
  stream_url = controlUrl(base, video->control);
  control_url = controlUrl(base, video->session_control);
}

void RtspSession::Connection::setUp() {
  std::string transport = "RTP/AVP/TCP;unicast;interleaved=0-1";
  if (isUdp()) {
    try {
      udp = std::make_unique<UdpPorts>(client.socket().peer().ss_family);
    } catch (const std::system_error& error) {
      throw RtspError(RtspError::Kind::unreachable, error.what());
    }
    transport = "RTP/AVP;unicast;client_port=" + std::to_string(udp->rtpPort()) + "-" +
                std::to_string(udp->rtpPort() + 1);
    udp->setPeer(client.socket().peer(), 0);
  }
  const RtspResponse response = client.request("SETUP", stream_url, {{"Transport", transport}}, deadline);
  requireSuccess("SETUP", response.head);
  const std::string_view answer = response.head.header("transport").value_or("");
  const bool is_other =
      isUdp() ? headerParameter(answer, "interleaved").has_value()
              : !headerParameter(answer, "interleaved") && headerParameter(answer, "server_port").has_value();
  const bool is_multicast = lowerCase(answer).find("multicast") != std::string::npos;
  if (is_other || is_multicast) {
    fail("answers SETUP with another transport" +
         (client.socket().quotes() ? " (" + quotedForMessage(answer) + "): " : ": ") +
         (is_multicast ? "switch multicast off in the camera"
                       : std::string("set cameras.transport: ") + (isUdp() ? "tcp" : "udp")));
  }
  if (isUdp()) {
    const int port = leadingNumber(headerParameter(answer, "server_port")).value_or(0);
    if (port > 0 && port < 65535) udp->setPeer(client.socket().peer(), static_cast<std::uint16_t>(port));
  } else {
    rtp_channel = leadingNumber(headerParameter(answer, "interleaved")).value_or(0);
  }
  const std::string_view header = response.head.header("session").value_or("");
  session = trimmed(header.substr(0, header.find(';')));
  const int timeout_s = leadingNumber(headerParameter(header, "timeout")).value_or(0);
  const Clock::duration timeout =
      timeout_s > 0 ? std::min(seconds(timeout_s), kMaxSessionTimeout) : kDefaultSessionTimeout;
  keep_alive_interval = timeout / 2;
}

/// Takes a packet of the TCP connection. Changes the channel if the server sends the stream on another one
/// than it answered to SETUP. Reports are known by their contents, on whichever channel they come.
void RtspSession::Connection::takeInterleaved(const RtspInput& input) {
  if (isRtcp(input.data)) return takeRtcp(input.data);
  if (!source && input.channel != rtp_channel) {
    const std::optional<RtpPacket> packet = parseRtpPacket(input.data);
    const bool is_stream = packet && packet->payload_type == payload_type;
    if (is_stream && ++packets_elsewhere >= kMaxPacketsElsewhere) rtp_channel = input.channel;
  }
  if (input.channel == rtp_channel) return takeRtp(input.data, client.socket().arrivalNs());
  remarks.add(Remark::channel, std::to_string(input.channel));
}

/// Takes a packet of the stream. Changes the payload type if only packets of another one come than is
/// described.
void RtspSession::Connection::takeRtp(std::span<const std::uint8_t> bytes, std::int64_t arrival_ns) {
  const std::optional<RtpPacket> packet = parseRtpPacket(bytes);
  if (!packet) return remarks.add(Remark::malformed);
  if (packet->payload_type != payload_type) {
    const bool is_another = packets_of_other_type++ > 0 && packet->payload_type != other_type;
    if (is_another) packets_of_other_type = 1;
    other_type = packet->payload_type;
    remarks.add(Remark::payload_type,
                std::to_string(other_type) + " instead of " + std::to_string(payload_type));
    if (source || packets_of_other_type < kMaxPacketsElsewhere) return;
    payload_type = other_type;
  }
  if (packet->payload.empty()) return;  // keeps a way through firewalls open
  source = packet->source;
  newest_timestamp = packet->timestamp;
  sequencer.add(*packet, {{bytes.begin(), bytes.end()}, arrival_ns, false});
}

void RtspSession::Connection::takeRtcp(std::span<const std::uint8_t> bytes) {
  const RtcpContent content = parseRtcp(bytes);
  if (!content.is_whole) remarks.add(Remark::malformed);
  for (const SenderReport& one : content.reports)
    takeReport(one);
  if (content.ended_source && content.ended_source == source) ended = true;
}

/// Takes a sender report. Some cameras put another source into it than into their packets: only one stream is
/// set up, so that it belongs to this one, unless reports of the source itself come, or its RTP time is
/// another.
void RtspSession::Connection::takeReport(SenderReport one) {
  if (one.instant_us < 0) return remarks.add(Remark::report, "that state a time before 1970: set its clock");
  if (source && one.source != *source) {
    const std::int64_t distance = static_cast<std::int32_t>(one.timestamp - newest_timestamp);
    const bool is_near = std::abs(distance) <= kMaxReportDistance;
    if (has_own_reports || !is_near) {
      return remarks.add(Remark::report, "of the source " + std::to_string(one.source) +
                                             ", while the packets' source is " + std::to_string(*source) +
                                             (is_near ? "" : ", and whose RTP time is another"));
    }
    one.source = *source;
  } else if (source) {
    has_own_reports = true;
  }
  report = one;
  report_arrival = Clock::now();
}

void RtspSession::Connection::receiveDatagrams() {
  for (int i = 0; i < kMaxUdpBatch; ++i) {
    const auto packet = udp->receive(0);
    if (!packet) break;
    isRtcp(*packet) ? takeRtcp(*packet) : takeRtp(*packet, udp->arrivalNs());
  }
  for (int i = 0; i < kMaxUdpBatch; ++i) {
    const auto packet = udp->receive(1);
    if (!packet) break;
    takeRtcp(*packet);
  }
  if (udp->foreign() > remarks.count(Remark::host))
    remarks.setTotal(Remark::host, udp->foreign(), udp->foreignAddress());
}

/// Sends the keep-alive request and the receiver report when they are due. False if the connection failed.
bool RtspSession::Connection::keepAlive() {
  const Clock::time_point now = Clock::now();
  if (now >= next_report) {
    next_report = now + kReportInterval;
    sendReceiverReport();
  }
  if (now < next_keep_alive) return true;
  next_keep_alive = now + keep_alive_interval;
  return client.send(keep_alive_method, control_url, sessionHeaders(), now + settings.stall_timeout);
}

void RtspSession::Connection::sendReceiverReport() {
  if (!source) return;
  ReceiverReport statistics;
  statistics.receiver = receiver;
  statistics.source = *source;
  statistics.lost = static_cast<std::uint32_t>(std::min<std::uint64_t>(sequencer.lost(), UINT32_MAX));
  statistics.highest_sequence = sequencer.highestSequence();
  if (report && report->source == *source) {
    const std::chrono::duration<double> since = Clock::now() - report_arrival;
    statistics.last_report = report->ntp_middle;
    statistics.since_last_report = static_cast<std::uint32_t>(std::min(since.count(), 65535.0) * 65536.0);
  }
  const std::vector<std::uint8_t> packet = receiverReportPacket(statistics);
  if (udp) return udp->sendRtcp(packet);
  std::vector<std::uint8_t> framed = {'$', static_cast<std::uint8_t>(rtp_channel + 1),
                                      static_cast<std::uint8_t>(packet.size() >> 8),
                                      static_cast<std::uint8_t>(packet.size() & 0xff)};
  framed.insert(framed.end(), packet.begin(), packet.end());
  client.socket().send(framed, Clock::now() + kTeardownTimeout);
}

/// Waits for something from the camera. Nothing if there may be packets now.
std::optional<RtspSession::Outcome> RtspSession::Connection::receiveInput(Clock::time_point until) {
  if (interrupted) return Outcome::interrupted;
  if (Clock::now() >= until) return Outcome::timed_out;
  if (!keepAlive()) {
    reason = "it takes no further requests";
    return Outcome::lost;
  }
  const Clock::time_point wake = std::min({until, next_keep_alive, next_report});
  const RtspInput input =
      client.socket().receive(wake, udp ? std::span<const int>(udp->descriptors()) : std::span<const int>());
  if (udp) receiveDatagrams();
  remarks.setTotal(Remark::stray_bytes, client.socket().skips());
  remarks.setTotal(Remark::late, sequencer.leftOut());
  switch (input.kind) {
    case RtspInput::Kind::nothing:
      break;
    case RtspInput::Kind::interleaved:
      takeInterleaved(input);
      break;
    case RtspInput::Kind::message:
      if (input.head.status >= 402) keep_alive_method = "OPTIONS";  // it does not know GET_PARAMETER
      if (client.takeResponse(input.head, Clock::now() + settings.stall_timeout)) break;
      reason = input.head.status == 0
                   ? "it takes no answer to its own requests"
                   : "it refuses to keep the session alive (" + statusText(input.head) + ")";
      return Outcome::lost;
    case RtspInput::Kind::closed:
      reason = input.reason;
      return Outcome::lost;
    case RtspInput::Kind::invalid:
      reason = "it " + input.reason;
      return Outcome::lost;
  }
  if (!ended) return std::nullopt;
  reason = "the camera ended the stream";
  return Outcome::lost;
}

/// Takes the next packet in order.
bool RtspSession::Connection::next(StreamFragment& fragment) {
  std::optional<SequencedPacket> packet = sequencer.pop();
  if (!packet) return false;
  current = std::move(*packet);
  const RtpPacket header = *parseRtpPacket(current.bytes);
  const std::int64_t last = last_timestamp.value_or(header.timestamp);
  last_timestamp = last + static_cast<std::int32_t>(header.timestamp - static_cast<std::uint32_t>(last));
  fragment.data = header.payload;
  fragment.pts = *last_timestamp;
  fragment.arrival_ns = current.arrival_ns;
  fragment.ends_picture = header.marker;
  fragment.data_lost = current.data_lost;
  fragment.reference_us.reset();
  if (report && report->source == header.source) {
    const auto since = static_cast<std::int32_t>(header.timestamp - report->timestamp);
    const std::int64_t reference_us = report->instant_us + static_cast<std::int64_t>(since) * 100 / 9;
    if (reference_us >= 0) fragment.reference_us = reference_us;
  }
  return true;
}

RtspSession::Outcome RtspSession::receive(StreamFragment& fragment, Clock::time_point deadline) {
  Connection& self = *connection_;
  while (!self.next(fragment)) {
    if (const std::optional<Outcome> outcome = self.receiveInput(deadline)) return *outcome;
  }
  return self.interrupted ? Outcome::interrupted : Outcome::fragment;
}

}  // namespace cartvo::capture
