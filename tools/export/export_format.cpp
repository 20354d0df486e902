// Names the formats and writes each of them.
#include "tools/export/export_format.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "common/atomic_file.hpp"
#include "tools/export/lcm_log.hpp"
#include "tools/export/mcap/foxglove_file.hpp"
#include "tools/export/ros/ros_bag.hpp"
#include "tools/replay/odometry_csv.hpp"

namespace cartvo {
namespace {

/// The source, which must have a replay.
const ExportSource& withReplay(const ExportSource& source) {
  if (source.replay) return source;
  throw std::runtime_error(source.path.string() +
                           ": is a trajectory, which has poses only; this format needs the recording or the "
                           "image folder");
}

}  // namespace

std::vector<std::string> exportFormatNames() {
  return {"mcap", "rosbag2-mcap", "lcm-log", "tum", "kitti", "euroc", "csv"};
}

ExportFormat exportFormatNamed(const std::string& name) {
  const std::vector<std::string> names = exportFormatNames();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) throw std::invalid_argument("no format " + name);
  return static_cast<ExportFormat>(std::distance(names.begin(), found));
}

std::vector<std::filesystem::path> exportedFiles(ExportFormat format, const std::filesystem::path& output) {
  if (format != ExportFormat::rosbag2_mcap) return {output};
  const auto files = rosBagFiles(output);
  return {files.begin(), files.end()};
}

void writeExport(const ExportSource& source, ExportFormat format, const std::filesystem::path& output,
                 const ExportProgress& progress) {
  switch (format) {
    case ExportFormat::mcap:
      return writeFoxgloveFile(output, source, progress);
    case ExportFormat::rosbag2_mcap:
      return writeRosBag(output, withReplay(source), progress);
    case ExportFormat::lcm_log:
      return writeLcmLog(output, *withReplay(source).replay);
    case ExportFormat::tum:
      return writeTum(output, source.poses, source.frame);
    case ExportFormat::kitti:
      if (!source.replay && source.frame != TrajectoryFrame::left_camera)
        std::fprintf(
            stderr,
            "cartvo: warning: KITTI's rows are poses of the left camera, and are read so; these are not "
            "known to be\n");
      return writeKitti(output, source.replay ? leftCameraTrajectory(*source.replay) : source.poses);
    case ExportFormat::euroc:
      return writeEuroc(output, source.poses);
    case ExportFormat::csv:
      return writeResultFile(output, odometryCsv(*withReplay(source).replay));
  }
}

}  // namespace cartvo
