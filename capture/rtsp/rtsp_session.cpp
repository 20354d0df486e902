// RTSP connection through FFmpeg's demuxer, without its parser.

#include "capture/rtsp/rtsp_session.hpp"

#include <array>
#include <cctype>
#include <optional>

#include "capture/codec/ffmpeg.hpp"
#include "capture/codec/ffmpeg_log.hpp"
#include "capture/rtsp/tcp_connect.hpp"
#include "common/host_clock.hpp"

namespace cartvo::capture {
namespace {

constexpr char kScheme[] = "rtsp://";
constexpr std::chrono::milliseconds kTeardownTimeout{200};  ///< for sending TEARDOWN, without its response

/// Percent-encodes all but unreserved characters (RFC 3986, 2.1).
std::string percentEncoded(const std::string& text) {
  std::string result;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0 || c == '-' || c == '.' || c == '_' || c == '~') {
      result += c;
    } else {
      constexpr char kDigits[] = "0123456789ABCDEF";
      result += {'%', kDigits[byte >> 4], kDigits[byte & 15]};
    }
  }
  return result;
}

/// URL with user and password, the only form that FFmpeg accepts. The result must not be logged or stored.
std::string urlForFfmpeg(const RtspCameraSettings& settings) {
  if (settings.credentials.user.empty()) return settings.url;
  return kScheme + percentEncoded(settings.credentials.user) + ":" +
         percentEncoded(settings.credentials.password) + "@" + settings.url.substr(sizeof(kScheme) - 1);
}

/// Owner of an AVDictionary.
class Options {
 public:
  ~Options() { av_dict_free(&dictionary_); }
  Options() = default;
  Options(const Options&) = delete;
  Options& operator=(const Options&) = delete;
  void set(const char* key, const std::string& value) { av_dict_set(&dictionary_, key, value.c_str(), 0); }
  AVDictionary** get() { return &dictionary_; }

 private:
  AVDictionary* dictionary_ = nullptr;
};

std::string noAnswerText(const RtspCameraSettings& settings) {
  return "no answer from the camera at " + rtspHost(settings.url) + " within " +
         std::to_string(settings.connect_timeout.count()) + " ms";
}

std::string openErrorText(int error, const RtspCameraSettings& settings) {
  const std::string host = rtspHost(settings.url);
  switch (error) {
    case AVERROR_HTTP_UNAUTHORIZED:
    case AVERROR_HTTP_FORBIDDEN:
      return settings.credentials.user.empty()
                 ? "the camera at " + host + " requires a user and password, and none are configured"
                 : "the camera at " + host + " refused the user or password (user '" +
                       settings.credentials.user +
                       "'); correct them, or wait if the camera has locked the account";
    case AVERROR_HTTP_NOT_FOUND:
      return "the camera at " + host + " has no such stream; check the path of its URL";
    case AVERROR_EXIT:
    case AVERROR(ETIMEDOUT):
      return noAnswerText(settings);
    default:
      return "cannot open the camera at " + host + ": " + ffmpeg::errorText(error);
  }
}

bool isRefusal(int error) {
  return error == AVERROR_HTTP_UNAUTHORIZED || error == AVERROR_HTTP_FORBIDDEN;
}

}  // namespace

struct RtspSession::Connection {
  Connection(const RtspCameraSettings& camera_settings, const std::atomic<bool>& stop)
      : settings(camera_settings),
        interrupted(stop),
        deadline(Clock::now() + camera_settings.connect_timeout) {}

  const RtspCameraSettings& settings;
  const std::atomic<bool>& interrupted;
  Clock::time_point deadline;
  ffmpeg::Packet packet = ffmpeg::makePacket();
  StreamFormat format;
  int stream_index = -1;
  std::string reason;
  std::optional<MissedPacketCounter> missed_packets;
  ffmpeg::Input input;  // last member: closed while `deadline` is still valid

  static int shouldAbort(void* self) {
    const auto& connection = *static_cast<const Connection*>(self);
    return connection.interrupted || Clock::now() >= connection.deadline ? 1 : 0;
  }

  void open();
  void selectStream();
};

RtspSession::RtspSession(const RtspCameraSettings& settings, const std::atomic<bool>& interrupted)
    : connection_(std::make_unique<Connection>(settings, interrupted)) {
  keepFfmpegQuiet();
  connection_->open();
  connection_->selectStream();
}

RtspSession::~RtspSession() {
  connection_->deadline = Clock::now() + kTeardownTimeout;
}

const StreamFormat& RtspSession::format() const {
  return connection_->format;
}

const std::string& RtspSession::reason() const {
  return connection_->reason;
}

void RtspSession::Connection::open() {
  if (const auto why = tcpConnectError(rtspHost(settings.url), settings.answer_timeout, interrupted))
    throw RtspError(RtspError::Kind::unreachable,
                    "cannot open the camera at " + rtspHost(settings.url) + ": " + *why);
  deadline = Clock::now() + settings.connect_timeout;
  AVFormatContext* context = avformat_alloc_context();
  if (context == nullptr) throw std::bad_alloc();
  context->interrupt_callback = {shouldAbort, this};
  // No parser: it would delay each picture until the next one begins.
  context->flags |= AVFMT_FLAG_NOPARSE | AVFMT_FLAG_NOFILLIN | AVFMT_FLAG_NOBUFFER;
  Options options;
  options.set("rtsp_transport", settings.transport == RtspTransport::tcp ? "tcp" : "udp");
  options.set("allowed_media_types", "video");
  options.set(
      "timeout",
      std::to_string(std::chrono::microseconds(settings.connect_timeout + settings.stall_timeout).count()));
  // Force the RTSP demuxer, whatever format a server announces.
  const AVInputFormat* rtsp = av_find_input_format("rtsp");
  const int error = avformat_open_input(&context, urlForFfmpeg(settings).c_str(), rtsp, options.get());
  if (error < 0) {  // FFmpeg has freed the context
    if (interrupted) throw RtspError(RtspError::Kind::interrupted, "interrupted");
    // FFmpeg reports a time-out by several error codes, "invalid data" among them.
    if (Clock::now() >= deadline) throw RtspError(RtspError::Kind::unreachable, noAnswerText(settings));
    throw RtspError(isRefusal(error) ? RtspError::Kind::refused : RtspError::Kind::unreachable,
                    openErrorText(error, settings));
  }
  input.reset(context);
  missed_packets.emplace(context);
}

void RtspSession::Connection::selectStream() {
  for (unsigned i = 0; i < input->nb_streams; ++i) {
    const AVCodecParameters& parameters = *input->streams[i]->codecpar;
    if (parameters.codec_id != AV_CODEC_ID_H264 && parameters.codec_id != AV_CODEC_ID_HEVC) continue;
    stream_index = static_cast<int>(i);
    format.codec = parameters.codec_id == AV_CODEC_ID_H264 ? VideoCodec::h264 : VideoCodec::h265;
    format.parameter_sets.assign(parameters.extradata, parameters.extradata + parameters.extradata_size);
    return;
  }
  throw RtspError(
      RtspError::Kind::unreachable,
      "the camera at " + rtspHost(settings.url) + " sends no H.264 or H.265 video; set its stream to H.264");
}

RtspSession::Outcome RtspSession::receive(StreamFragment& fragment, Clock::time_point deadline) {
  Connection& self = *connection_;
  self.deadline = deadline;
  for (;;) {
    av_packet_unref(self.packet.get());
    const int error = av_read_frame(self.input.get(), self.packet.get());
    if (self.interrupted) return Outcome::interrupted;
    if (error == AVERROR(EAGAIN) && Clock::now() < deadline) continue;
    if (error < 0) {
      if (Clock::now() >= deadline) return Outcome::timed_out;
      self.reason = error == AVERROR_EOF ? "the camera closed the connection" : ffmpeg::errorText(error);
      return Outcome::lost;
    }
    if (self.packet->stream_index != self.stream_index || self.packet->size <= 0) continue;
    break;
  }
  const AVPacket& packet = *self.packet;
  fragment.arrival_ns = hostNow();
  fragment.data = {packet.data, static_cast<std::size_t>(packet.size)};
  if (packet.pts != AV_NOPTS_VALUE)
    fragment.pts = packet.pts;  // else it belongs to the previous packet's picture
  fragment.data_lost = self.missed_packets->fetchAndReset() > 0 || (packet.flags & AV_PKT_FLAG_CORRUPT) != 0;
  fragment.reference_us.reset();
  std::size_t size = 0;
  const std::uint8_t* side_data = av_packet_get_side_data(&packet, AV_PKT_DATA_PRFT, &size);
  if (side_data != nullptr && size >= sizeof(AVProducerReferenceTime)) {
    fragment.reference_us = reinterpret_cast<const AVProducerReferenceTime*>(side_data)->wallclock;
  }
  return Outcome::fragment;
}

void checkRtspUrl(const std::string& url) {
  if (url.rfind(kScheme, 0) != 0) {
    throw std::invalid_argument(
        "a camera's URL must begin with rtsp://, as in rtsp://192.168.1.64:554/Streaming/"
        "Channels/101");
  }
  for (const char c : url) {
    if (std::isspace(static_cast<unsigned char>(c)) != 0 ||
        std::iscntrl(static_cast<unsigned char>(c)) != 0) {
      throw std::invalid_argument("a camera's URL must not contain white space");
    }
  }
  const std::string host = rtspHost(url);
  if (host.find('@') != std::string::npos) {
    throw std::invalid_argument(
        "a camera's URL must not contain a user or password (the part before '@'), because URLs are logged; "
        "give them as the camera's credentials");
  }
  if (host.empty()) throw std::invalid_argument("a camera's URL must contain a host after rtsp://");
}

std::string rtspHost(const std::string& url) {
  const std::size_t begin = std::min(url.size(), sizeof(kScheme) - 1);
  return url.substr(begin, url.find_first_of("/?#", begin) - begin);
}

}  // namespace cartvo::capture
