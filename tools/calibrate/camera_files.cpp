// Opens the two cameras of a source on disk.
#include "tools/calibrate/camera_files.hpp"

#include <utility>

#include "capture/dataset/video_file_source.hpp"
#include "capture/stereo_source.hpp"

namespace cartvo::calibrate {

CameraFiles openCameraFiles(const std::filesystem::path& source, const std::filesystem::path& right,
                            double frame_rate) {
  CameraFiles cameras;
  if (std::filesystem::is_regular_file(source)) {
    capture::VideoFileTime time;
    time.frame_rate = frame_rate;
    auto left = std::make_unique<capture::VideoFileSource>(source, time);
    cameras.pictures = left->expectedPictures();
    cameras.left = std::move(left);
    if (!right.empty()) cameras.right = std::make_unique<capture::VideoFileSource>(right, time);
    return cameras;
  }
  capture::SourceSettings settings;
  settings.frame_rate = frame_rate;
  capture::StereoSource both = capture::openSource(source, settings);
  return {std::move(both.left), std::move(both.right), both.pairs};
}

}  // namespace cartvo::calibrate
