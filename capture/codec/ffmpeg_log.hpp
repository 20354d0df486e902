#pragma once

#include <functional>
#include <string>

namespace cartvo::capture {

/// Receives FFmpeg's messages, one line each, without credentials.
using FfmpegLogSink = std::function<void(const std::string& message)>;

/// Redirects FFmpeg's warnings and errors, with credentials removed, from stderr to `sink`; an empty sink
/// discards them. By default FFmpeg prints URLs with their passwords. The sink may be called from any thread.
void setFfmpegLogSink(FfmpegLogSink sink);

/// Silences FFmpeg unless a sink was set already. Every user of FFmpeg in capture calls it before its first
/// use.
void keepFfmpegQuiet();

/// Counts the RTP packets that a demuxer has missed, from FFmpeg's log: FFmpeg joins the fragments around the
/// gap and reports it in its log only. Use between two calls of av_read_frame, in one thread.
class MissedPacketCounter {
 public:
  /// `demuxer`: the AVFormatContext, used for comparison only.
  explicit MissedPacketCounter(const void* demuxer);
  ~MissedPacketCounter();
  MissedPacketCounter(const MissedPacketCounter&) = delete;
  MissedPacketCounter& operator=(const MissedPacketCounter&) = delete;

  /// Returns the number of packets missed since the last call, and resets it.
  int fetchAndReset();

 private:
  const void* demuxer_;
};

/// Replaces the user and password of each URL in a text by "***".
std::string withoutCredentials(const std::string& text);

}  // namespace cartvo::capture
