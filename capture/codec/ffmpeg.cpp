// Helpers for FFmpeg's objects.

#include "capture/codec/ffmpeg.hpp"

#include <array>
#include <cstring>
#include <new>

namespace cartvo::capture::ffmpeg {

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

void readPictureSize(AVCodecParameters& parameters, const std::vector<std::uint8_t>& picture) {
  const CodecContext context(avcodec_alloc_context3(avcodec_find_decoder(parameters.codec_id)));
  const std::unique_ptr<AVCodecParserContext, decltype(&av_parser_close)> parser(
      av_parser_init(parameters.codec_id), av_parser_close);
  if (!context || !parser) throw std::bad_alloc();
  if (avcodec_parameters_to_context(context.get(), &parameters) < 0) return;
  parser->flags |= PARSER_FLAG_COMPLETE_FRAMES;
  std::uint8_t* parsed = nullptr;
  int parsed_size = 0;
  av_parser_parse2(parser.get(), context.get(), &parsed, &parsed_size, picture.data(),
                   static_cast<int>(picture.size()), AV_NOPTS_VALUE, AV_NOPTS_VALUE, 0);
  parameters.width = parser->width;
  parameters.height = parser->height;
}

}  // namespace cartvo::capture::ffmpeg
