#pragma once

#include <functional>
#include <string>

namespace cartvo {

/// FFmpeg's own messages, one line each, without credentials.
using FfmpegLogSink = std::function<void(const std::string& message)>;

/// FFmpeg prints URLs, passwords included, to stderr. From the first call on its warnings and errors go to
/// `sink` instead, credentials removed; an empty sink silences them. The sink is called from any thread.
void setFfmpegLogSink(FfmpegLogSink sink);

/// Silences FFmpeg unless a sink was set already. Each user of FFmpeg in capture calls it before its first
/// use.
void keepFfmpegQuiet();

/// Learns of RTP packets that a demuxer has missed: FFmpeg puts the pictures' pieces together around the gap
/// and says so in its log only. Between two calls of av_read_frame, in one thread.
class MissedPackets {
 public:
  /// `demuxer`: the AVFormatContext, which is only compared.
  explicit MissedPackets(const void* demuxer);
  ~MissedPackets();
  MissedPackets(const MissedPackets&) = delete;
  MissedPackets& operator=(const MissedPackets&) = delete;

  /// How many were missed since the last call.
  int take();

 private:
  const void* demuxer_;
};

/// Replaces the user and password of each URL in a text by "***".
std::string withoutCredentials(const std::string& text);

}  // namespace cartvo
