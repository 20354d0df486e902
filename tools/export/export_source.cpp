// Reads what is exported: a replay or a trajectory.
#include "tools/export/export_source.hpp"

#include <stdexcept>
#include <string>

#include "capture/recording/recording_folder.hpp"

namespace cartvo {
namespace {

namespace fs = std::filesystem;

bool isVideo(const fs::path& file) {
  const std::string extension = file.extension().string();
  return extension == ".mp4" || extension == ".mkv" || extension == ".avi" || extension == ".mov" ||
         extension == ".h264" || extension == ".h265";
}

ExportSource readPoses(const fs::path& file) {
  if (isVideo(file)) {
    throw std::runtime_error(file.string() +
                             ": is a video; run 'cartvo replay' on it first and export its output folder");
  }
  ExportSource source;
  source.path = file;
  source.poses = readTrajectory(file);
  if (isKittiTrajectory(file)) {
    throw std::runtime_error(
        file.string() +
        ": is a trajectory in KITTI's format, which has no times; export one in TUM's or "
        "EuRoC's format, such as trajectory.tum of 'cartvo replay'");
  }
  source.frame = frameOf(file);
  return source;
}

}  // namespace

ExportSource readExportSource(const fs::path& path, const fs::path& rig, const ReplayObserver& observer) {
  if (!fs::exists(path)) throw std::runtime_error(path.string() + ": does not exist");
  if (!fs::is_directory(path)) return readPoses(path);
  if (fs::exists(path / "trajectory.tum") && !capture::isRecording(path))
    return readPoses(path / "trajectory.tum");
  ReplaySettings settings;
  settings.source = path;
  settings.rig = rig;
  ExportSource source;
  source.path = path;
  source.replay = replaySource(settings, observer);
  source.has_video = capture::isRecording(path);
  source.poses = bodyTrajectory(*source.replay);
  source.frame = bodyTrajectoryFrame(*source.replay);
  return source;
}

std::int64_t receptionTime(const ReplayedPair& pair) {
  constexpr std::int64_t kNanosecondsPerMicrosecond = 1000;
  return pair.message.arrival_utime == 0 ? pair.exposure_ns
                                         : kNanosecondsPerMicrosecond * pair.message.arrival_utime;
}

}  // namespace cartvo
