#include "capture/ffmpeg.hpp"

#include <array>
#include <cstring>
#include <new>

namespace cartvo::ffmpeg {

Packet makePacket() {
  Packet packet(av_packet_alloc());
  if (!packet) throw std::bad_alloc();
  return packet;
}

std::string errorText(int error) {
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(error, text.data(), text.size());
  return text.data();
}

AVCodecID codecId(VideoCodec codec) {
  return codec == VideoCodec::h264 ? AV_CODEC_ID_H264 : AV_CODEC_ID_HEVC;
}

void setExtradata(AVCodecParameters& parameters, const std::vector<std::uint8_t>& data) {
  parameters.extradata = static_cast<std::uint8_t*>(av_mallocz(data.size() + AV_INPUT_BUFFER_PADDING_SIZE));
  if (parameters.extradata == nullptr) throw std::bad_alloc();
  std::memcpy(parameters.extradata, data.data(), data.size());
  parameters.extradata_size = static_cast<int>(data.size());
}

}  // namespace cartvo::ffmpeg
