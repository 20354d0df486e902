#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "capture/encoded_unit.hpp"
#include "capture/ffmpeg.hpp"

namespace cartvo {

/// Writes one camera's stream as received into a Matroska file, with its index beside it. Not for use outside
/// capture; StreamRecorder shields the capture from its errors.
class StreamWriter {
 public:
  /// Writes STREAM.mkv and STREAM.csv; the video file begins with the first key picture.
  StreamWriter(const std::filesystem::path& folder, const std::string& stream);
  ~StreamWriter();
  StreamWriter(const StreamWriter&) = delete;
  StreamWriter& operator=(const StreamWriter&) = delete;

  /// Units of this format follow. Throws std::runtime_error if the codec changes in mid-file.
  void begin(const StreamFormat& format);

  /// Returns whether the unit was written: what comes before the first key picture is not. Throws
  /// std::runtime_error naming the file when it cannot be written.
  bool write(const EncodedUnit& unit);

 private:
  void open(const EncodedUnit& first);
  std::int64_t fileTime(const EncodedUnit& unit);
  void flush();
  void check(int result) const;

  std::filesystem::path video_file_;
  std::filesystem::path index_file_;
  std::optional<StreamFormat> format_;
  bool connection_began_ = false;  ///< no unit since `begin`
  std::unique_ptr<AVFormatContext, void (*)(AVFormatContext*)> output_;
  ffmpeg::Packet packet_ = ffmpeg::makePacket();
  std::ofstream index_;
  std::uint64_t units_ = 0;
  std::int64_t last_time_ms_ = -1;
  std::int64_t last_exposure_ns_ = 0;
  std::int64_t last_arrival_ns_ = 0;
  std::chrono::steady_clock::time_point last_flush_;
};

}  // namespace cartvo
