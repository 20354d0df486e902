#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include <opencv2/core/mat.hpp>

namespace cartvo {

/// Writes pictures as H.264 into an MP4 file, which gets its name in finish() (AtomicFileWriter).
class Mp4Writer {
 public:
  /// Throws std::runtime_error if libx264 is missing or the file cannot be made. The folder must exist.
  explicit Mp4Writer(const std::filesystem::path& file);
  ~Mp4Writer();
  Mp4Writer(const Mp4Writer&) = delete;
  Mp4Writer& operator=(const Mp4Writer&) = delete;

  /// Adds a picture (CV_8UC3, BGR), with even width and height, all of the same size. `time_ns` should
  /// increase; a picture that is not later than the last one follows it by 1 ms, and one more than 5 s later
  /// by 1 s. Throws std::runtime_error naming the file.
  void add(const cv::Mat& picture, std::int64_t time_ns);

  /// Completes the file and gives it its name, in place of a file that has it. Needs at least one picture.
  void finish();

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo
