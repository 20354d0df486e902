// An RTSP client of the simulated camera, by libavformat.
#include "support/tools/stream_client.hpp"

#include <chrono>
#include <memory>

extern "C" {
#include <libavformat/avformat.h>
}

#include "support/test_timeout.hpp"

namespace cartvo::test {
namespace {

using Clock = std::chrono::system_clock;

std::int64_t nowNs() {
  return std::chrono::nanoseconds(Clock::now().time_since_epoch()).count();
}

struct Deadline {
  Clock::time_point at;
};

int isPast(void* deadline) {
  return Clock::now() > static_cast<Deadline*>(deadline)->at ? 1 : 0;
}

std::int64_t instantOf(const AVPacket& packet) {
  const auto* reference = reinterpret_cast<const AVProducerReferenceTime*>(
      av_packet_get_side_data(&packet, AV_PKT_DATA_PRFT, nullptr));
  return reference != nullptr ? reference->wallclock * 1000 : 0;
}

}  // namespace

ReceivedStream receive(std::uint16_t port, const std::string& user_and_password, int packets) {
  ReceivedStream received;
  Deadline deadline{Clock::now() + kTestTimeout};
  AVFormatContext* context = avformat_alloc_context();
  context->interrupt_callback = {.callback = isPast, .opaque = &deadline};
  AVDictionary* options = nullptr;
  av_dict_set(&options, "rtsp_transport", "tcp", 0);
  const std::string url =
      "rtsp://" + user_and_password + "@127.0.0.1:" + std::to_string(port) + "/Streaming/Channels/101";
  received.open_error = avformat_open_input(&context, url.c_str(), nullptr, &options);
  av_dict_free(&options);
  if (received.open_error < 0) return received;

  AVPacket* packet = av_packet_alloc();
  while (static_cast<int>(received.packets.size()) < packets) {
    deadline.at = Clock::now() + kTestTimeout;
    const int result = av_read_frame(context, packet);
    if (result < 0) {
      received.ended = result == AVERROR_EOF;
      break;
    }
    received.packets.push_back({.pts = packet->pts,
                                .key_frame = (packet->flags & AV_PKT_FLAG_KEY) != 0,
                                .instant_ns = instantOf(*packet),
                                .arrival_ns = nowNs()});
    av_packet_unref(packet);
  }
  av_packet_free(&packet);
  avformat_close_input(&context);
  return received;
}

}  // namespace cartvo::test
