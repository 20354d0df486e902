#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "capture/frame.hpp"

// Encoded pictures and streams, as a camera sends them.

namespace cartvo::capture {

/// Codec of a stream.
enum class VideoCodec : std::uint8_t { h264, h265 };

/// Parameters of a stream that a decoder or file needs before its first picture.
struct StreamFormat {
  VideoCodec codec = VideoCodec::h264;
  std::vector<std::uint8_t> parameter_sets;  ///< Annex B, from the session description; may be empty
};

/// One picture as the camera sent it, with its time stamps.
struct EncodedUnit : FrameTimestamps {
  std::vector<std::uint8_t> data;  ///< an access unit in Annex B form (with start codes)
  std::int64_t pts = 0;            ///< RTP time stamp, unwrapped, 1/90000 s; continuous within one connection
  std::int64_t first_arrival_ns = 0;         ///< reception of its first packet, host's clock
  std::optional<std::int64_t> reference_us;  ///< as RtpTimestamps'
  FrameStatus status = FrameStatus::good;    ///< damaged: data were lost since the last key frame
  bool data_lost = false;                    ///< data are missing before or in it
  bool key = false;                          ///< decodable without the pictures before it
};

/// Receives a camera's stream, encoded as received (used by the recorder). Called in the thread that reads
/// the camera: must return quickly and must not throw.
class StreamObserver {
 public:
  virtual ~StreamObserver() = default;

  /// Called when a connection was opened; units of this format follow.
  virtual void onStream(const StreamFormat& format) noexcept = 0;
  virtual void onUnit(const EncodedUnit& unit) noexcept = 0;
};

}  // namespace cartvo::capture
