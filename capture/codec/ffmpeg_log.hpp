#pragma once

namespace cartvo::capture {

/// Silences FFmpeg, which by default prints URLs with their passwords to stderr. Every user of FFmpeg in
/// capture calls it before its first use.
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

}  // namespace cartvo::capture
