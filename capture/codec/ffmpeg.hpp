#pragma once

// Owning pointers and helpers for FFmpeg's objects; internal to capture.

#include <cstdint>
#include <memory>
#include <string>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavcodec/bsf.h>
#include <libavformat/avformat.h>
}

#include "capture/encoded_unit.hpp"

namespace cartvo::capture::ffmpeg {

struct InputCloser {
  void operator()(AVFormatContext* context) const { avformat_close_input(&context); }
};
struct CodecContextFree {
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
};
struct PacketFree {
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};
struct FilterFree {
  void operator()(AVBSFContext* filter) const { av_bsf_free(&filter); }
};

using Input = std::unique_ptr<AVFormatContext, InputCloser>;
using CodecContext = std::unique_ptr<AVCodecContext, CodecContextFree>;
using Packet = std::unique_ptr<AVPacket, PacketFree>;
using Filter = std::unique_ptr<AVBSFContext, FilterFree>;

/// Throws std::bad_alloc.
Packet makePacket();

/// FFmpeg's text for one of its error codes. Contains no URL.
std::string errorText(int error);

AVCodecID codecId(VideoCodec codec);

/// Copies `data` into memory allocated by FFmpeg, with the padding it requires. Throws std::bad_alloc.
void setExtradata(AVCodecParameters& parameters, const std::vector<std::uint8_t>& data);

/// Sets width and height from the parameter sets in the extradata or in `picture`, a key picture; leaves them
/// unchanged if that fails.
void readPictureSize(AVCodecParameters& parameters, const std::vector<std::uint8_t>& picture);

}  // namespace cartvo::capture::ffmpeg
