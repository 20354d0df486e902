// The video of a replay.
#include "tools/replay/video/video_recorder.hpp"

#include "common/atomic_file.hpp"

namespace cartvo {
namespace {

/// The file, in a folder that exists.
const std::filesystem::path& inFolder(const std::filesystem::path& file) {
  if (file.has_parent_path()) createFolders(file.parent_path());
  return file;
}

}  // namespace

VideoRecorder::VideoRecorder(const std::filesystem::path& file) : writer_(inFolder(file)) {}

void VideoRecorder::add(const pipeline::PairResult& result) {
  writer_.add(pictures_.draw(result, view_.left, view_.landmarks), result.left.exposure_ns);
}

}  // namespace cartvo
