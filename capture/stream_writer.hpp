#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <vector>

#include "capture/camera_side.hpp"
#include "capture/encoded_unit.hpp"
#include "capture/ffmpeg.hpp"
#include "capture/recording_folder.hpp"

namespace cartvo {

/// Writes one camera's stream as received into one segment: a Matroska file and its index. Not for use
/// outside capture; StreamRecorder shields the capture from its errors. All members throw std::runtime_error
/// naming the file when it cannot be written.
class StreamWriter {
 public:
  /// The files begin with `first`, a key picture; file times count from `epoch_ns` by the host's clock, the
  /// segment's beginning.
  StreamWriter(const RecordingSegment& segment, CameraSide side, const StreamFormat& format,
               const EncodedUnit& first, std::int64_t epoch_ns);
  /// Ends the files properly.
  ~StreamWriter();
  StreamWriter(const StreamWriter&) = delete;
  StreamWriter& operator=(const StreamWriter&) = delete;

  /// `connection`: counts the camera's connections; with a new one, `format` may have other parameter sets.
  void write(const EncodedUnit& unit, const StreamFormat& format, std::uint64_t connection);

  /// What was written survives a power cut once this returns.
  void sync();

  VideoCodec codec() const { return codec_; }

 private:
  void open(const StreamFormat& format, const EncodedUnit& first);
  void writeVideo(const std::vector<std::uint8_t>& data, std::int64_t time_ms, bool key);
  std::int64_t fileTime(const EncodedUnit& unit);
  void check(int result) const;

  std::filesystem::path video_file_;
  std::filesystem::path index_file_;
  VideoCodec codec_;
  std::int64_t epoch_ns_;
  std::unique_ptr<AVFormatContext, void (*)(AVFormatContext*)> output_;
  ffmpeg::Packet packet_ = ffmpeg::makePacket();
  std::ofstream index_;
  std::uint64_t units_ = 0;
  std::uint64_t last_connection_ = 0;
  std::int64_t last_time_ms_ = 0;
  std::int64_t last_exposure_ns_ = 0;
  std::int64_t last_arrival_ns_ = 0;
};

}  // namespace cartvo
