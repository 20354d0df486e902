// KITTI's layouts: the odometry sequences (numbered images, calib.txt, times.txt) and the raw recordings.

#include <array>
#include <stdexcept>

#include "capture/dataset/dates_and_times.hpp"
#include "capture/dataset/image_folder_layouts.hpp"
#include "capture/dataset/image_instants.hpp"

namespace cartvo::capture {
namespace {

namespace fs = std::filesystem;

ImageSequence readRawCamera(const fs::path& folder) {
  const fs::path file = folder / "timestamps.txt";
  ImageSequence sequence;
  sequence.images = listImages(folder / "data");
  sequence.instants_ns = readDatesAndTimes(file);
  requireInstantForEachImage(sequence, folder / "data", file);
  return sequence;
}

/// The cameras of a raw recording: the grey ones, else the coloured ones; nothing if it has neither pair.
std::optional<std::array<int, 2>> rawCameras(const fs::path& folder) {
  for (const std::array<int, 2> cameras : {std::array{0, 1}, std::array{2, 3}}) {
    const auto has = [&](int camera) {
      return fs::is_directory(folder / ("image_0" + std::to_string(camera)) / "data");
    };
    if (has(cameras[0]) && has(cameras[1])) return cameras;
  }
  return std::nullopt;
}

}  // namespace

bool isKittiFolder(const fs::path& folder) {
  return !findImageSubfolders(folder).left.empty();
}

ImageFolder readKittiFolder(const fs::path& folder, const ImageFolderSettings& settings) {
  const ImageSubfolders images = findImageSubfolders(folder);
  ImageFolder result;
  result.layout = FolderLayout::kitti;
  result.folder = folder;
  if (images.is_colour) result.cameras = {2, 3};
  result.left.images = listImages(images.left);
  result.right.images = listImages(images.right);
  readInstants(result, {folder}, settings.frame_rate);
  result.calib_file = pathIfExists(folder / "calib.txt");
  result.rig_file = pathIfExists(folder / "rig.yaml");
  return result;
}

bool isKittiRawFolder(const fs::path& folder) {
  return rawCameras(folder).has_value();
}

ImageFolder readKittiRawFolder(const fs::path& folder) {
  ImageFolder result;
  result.layout = FolderLayout::kitti_raw;
  result.folder = folder;
  result.cameras = *rawCameras(folder);
  const auto camera_folder = [&](int camera) { return folder / ("image_0" + std::to_string(camera)); };
  result.left = readRawCamera(camera_folder(result.cameras[0]));
  result.right = readRawCamera(camera_folder(result.cameras[1]));
  // The calibration of a day lies beside its drives.
  for (const fs::path& place : {folder, fs::absolute(folder).lexically_normal().parent_path()}) {
    if (result.calib_file.empty()) result.calib_file = pathIfExists(place / "calib_cam_to_cam.txt");
  }
  result.rig_file = pathIfExists(folder / "rig.yaml");
  return result;
}

}  // namespace cartvo::capture
