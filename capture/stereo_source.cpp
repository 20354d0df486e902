// Detection and opening of recordings and image folders.

#include "capture/stereo_source.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "capture/recording/recording_folder.hpp"
#include "capture/recording/recording_source.hpp"
#include "common/files/foreign_format.hpp"

namespace cartvo::capture {
namespace {

StereoSource openRecording(const std::filesystem::path& path, const SourceSettings& settings) {
  RecordingInfo info = readRecordingInfo(path);
  StereoSource source;
  source.kind = SourceKind::recording;
  if (settings.clock) source.clock = std::make_shared<RecordingTimestamper>(path, *settings.clock);
  source.left = std::make_unique<RecordingSource>(path, CameraSide::left, source.clock);
  source.right = std::make_unique<RecordingSource>(path, CameraSide::right, source.clock);
  source.rig_text = std::move(info.rig);
  return source;
}

SourceKind kindOf(FolderLayout layout) {
  switch (layout) {
    case FolderLayout::kitti_raw:
      return SourceKind::kitti_raw;
    case FolderLayout::euroc:
      return SourceKind::euroc;
    case FolderLayout::lists:
      return SourceKind::lists;
    case FolderLayout::one_folder:
      return SourceKind::one_folder;
    default:
      return SourceKind::kitti;
  }
}

StereoSource openImageFolder(const std::filesystem::path& path, const SourceSettings& settings) {
  ImageFolder folder = readImageFolder(path, {settings.frame_rate, settings.side_by_side});
  folder.left.stddev_ns = folder.right.stddev_ns =
      std::llround(settings.folder_offset_stddev_ns / std::sqrt(2.0));
  StereoSource source;
  source.kind = kindOf(folder.layout);
  source.period_ns = std::min(nominalPeriodNs(folder.left), nominalPeriodNs(folder.right));
  source.pairs = std::min(folder.left.images.size(), folder.right.images.size());
  source.first_image = folder.left.images.front();
  source.part = folder.left.part;
  source.left = std::make_unique<ImageSequenceSource>(std::move(folder.left));
  source.right = std::make_unique<ImageSequenceSource>(std::move(folder.right));
  source.warnings = std::move(folder.warnings);
  source.cameras = folder.cameras;
  source.calib_file = std::move(folder.calib_file);
  source.rig_file = std::move(folder.rig_file);
  source.sensor_files = std::move(folder.sensor_files);
  return source;
}

}  // namespace

StereoSource openSource(const std::filesystem::path& path) {
  return openSource(path, SourceSettings{});
}

StereoSource openSource(const std::filesystem::path& path, const SourceSettings& settings) {
  if (!std::filesystem::exists(path))
    throw std::runtime_error(path.string() + " does not exist; expected a folder with a recording or images");
  const bool is_folder = std::filesystem::is_directory(path);
  if (const std::string foreign = foreignFormat(path); !foreign.empty())
    throw std::runtime_error(path.string() + " " + foreign);
  if (!is_folder)
    throw std::runtime_error(path.string() +
                             " is not a folder; expected a folder with a recording or images, or two videos");
  if (isRecording(path) && settings.frame_rate > 0.0) {
    throw std::runtime_error(
        path.string() +
        ": a recording has its own instants; --frame-rate is for videos and for folders of "
        "images without instants");
  }
  if (isRecording(path) && settings.side_by_side) {
    throw std::runtime_error(path.string() +
                             ": a recording has a stream for each camera; --side-by-side is for images and "
                             "videos that contain both cameras' pictures");
  }
  if (isRecording(path)) return openRecording(path, settings);
  if (settings.side_by_side || detectImageFolder(path)) return openImageFolder(path, settings);
  if (std::filesystem::exists(path / "000000/left.mkv")) {
    throw std::runtime_error(path.string() +
                             ": has the parts of a recording, but no recording.json; copy it from where the "
                             "recording was made, or replay a part's left.mkv and right.mkv as videos");
  }
  if (const std::string contents = foreignContents(path); !contents.empty())
    throw std::runtime_error(path.string() + " " + contents);
  throw std::runtime_error(path.string() +
                           " cannot be replayed. Looked for: a recording (recording.json and "
                           "000000/left.mkv), " +
                           kLayouts);
}

}  // namespace cartvo::capture
