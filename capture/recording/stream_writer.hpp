#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <vector>

#include "capture/camera_side.hpp"
#include "capture/codec/ffmpeg.hpp"
#include "capture/encoded_unit.hpp"
#include "capture/recording/recording_folder.hpp"

namespace cartvo::capture {

/// Writes one camera's stream as received into one segment: a Matroska file and its index. Internal to
/// capture: StreamRecorder handles its errors. All members throw std::runtime_error naming the file if it
/// cannot be written.
class StreamWriter {
 public:
  /// `first`: the key picture that the files begin with. File times are relative to `epoch_ns`, the segment's
  /// start by the host's clock.
  StreamWriter(const RecordingSegment& segment, CameraSide side, const StreamFormat& format,
               const EncodedUnit& first, std::int64_t epoch_ns);
  /// Finalises the files.
  ~StreamWriter();
  StreamWriter(const StreamWriter&) = delete;
  StreamWriter& operator=(const StreamWriter&) = delete;

  /// Writes a picture. `connection`: the camera's connection, counted from 1; a new connection may have other
  /// parameter sets in `format`.
  void write(const EncodedUnit& unit, const StreamFormat& format, std::uint64_t connection);

  /// Writes everything to the disk, so that it survives a power cut.
  void sync();

  VideoCodec codec() const { return codec_; }

 private:
  void open(const StreamFormat& format, const EncodedUnit& first);
  void writeVideo(const std::vector<std::uint8_t>& data, std::int64_t time_ms, bool key);
  std::int64_t nextFileTimeMs(const EncodedUnit& unit);
  void requireSuccess(int result) const;

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

}  // namespace cartvo::capture
