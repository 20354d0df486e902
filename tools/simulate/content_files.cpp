// Writes images, instants, rig and ground truth of a content as files.
#include "tools/simulate/content_files.hpp"

#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>

#include <opencv2/imgcodecs.hpp>

#include "calib/format/kitti_rig.hpp"
#include "calib/format/rig_file.hpp"
#include "common/atomic_file.hpp"
#include "common/files/unfinished_folder.hpp"
#include "tools/simulate/truth.hpp"
#include "tools/trajectory/trajectory.hpp"

namespace cartvo::simulate {
namespace fs = std::filesystem;
namespace {

std::string decimalSeconds(std::int64_t time_ns) {
  const std::int64_t magnitude = time_ns < 0 ? -time_ns : time_ns;
  char text[40];
  std::snprintf(text, sizeof text, "%s%lld.%09lld", time_ns < 0 ? "-" : "",
                static_cast<long long>(magnitude / 1'000'000'000),
                static_cast<long long>(magnitude % 1'000'000'000));
  return text;
}

void writeImage(const fs::path& folder, int index, const cv::Mat& image) {
  char name[24];
  std::snprintf(name, sizeof name, "%06d.png", index);
  const fs::path file = folder / name;
  if (!cv::imwrite(file.string(), image)) throw std::runtime_error(file.string() + ": cannot be written");
}

}  // namespace

void writeDescription(const fs::path& folder, const Content& content) {
  createFolders(folder);
  const calib::Rig rig = content.rig();
  calib::writeRig(folder / "rig.yaml", rig);
  std::string left_times;
  std::string right_times;
  for (int index = 0; index < content.pairCount(); ++index) {
    left_times += decimalSeconds(content.leftInstant(index)) + "\n";
    right_times += decimalSeconds(content.rightInstant(index)) + "\n";
  }
  writeResultFile(folder / "times_0.txt", left_times);
  writeResultFile(folder / "times_1.txt", right_times);
  const Trajectory truth = content.truth();
  if (!truth.empty())
    writeKitti(folder / "poses.txt", cameraTrajectory(truth, rig), TrajectoryFrame::left_camera);
}

void writeTruth(const fs::path& folder, const Content& content, std::int64_t epoch_ns) {
  const Trajectory truth = content.denseTruth();
  if (!truth.empty()) writeTum(folder / "truth.tum", shifted(truth, epoch_ns), TrajectoryFrame::body);
}

void renderFolder(const fs::path& folder, const Content& content, const Progress& progress) {
  if (fs::exists(folder) && !(fs::is_directory(folder) && fs::is_empty(folder))) {
    throw std::runtime_error(folder.string() + ": exists and is not empty; name a new folder");
  }
  fs::path partial = fs::absolute(folder).lexically_normal();
  if (!partial.has_filename()) partial = partial.parent_path();
  partial += ".partial";
  fs::remove_all(partial);  // from an interrupted run
  UnfinishedFolder unfinished(partial);
  createFolders(partial / "image_0");
  createFolders(partial / "image_1");

  cv::Mat left;
  cv::Mat right;
  for (int index = 0; index < content.pairCount(); ++index) {
    content.images(index, left, right);
    writeImage(partial / "image_0", index, left);
    writeImage(partial / "image_1", index, right);
    if (progress) progress(index + 1, content.pairCount());
  }
  writeDescription(partial, content);
  writeTruth(partial, content, 0);
  if (calib::isKittiRig(content.rig()))
    writeResultFile(partial / "calib.txt", calib::kittiText(content.rig()));
  fs::rename(partial, folder);
  unfinished.keep();
}

}  // namespace cartvo::simulate
