#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "capture/camera_source.hpp"
#include "capture/dataset/image_files.hpp"

// Image folders in the layouts of data sets as frame sources.

namespace cartvo::capture {

/// Layout of an image folder.
enum class FolderLayout : std::uint8_t { kitti, kitti_raw, euroc };

/// One camera's image files, in the order of their exposure.
struct ImageSequence {
  std::vector<std::filesystem::path> images;
  std::vector<std::int64_t> instants_ns;  ///< of exposure, strictly increasing; one per image
  std::int64_t stddev_ns = 0;             ///< standard deviation of the instants
  int used_bits = 16;                     ///< of 16-bit images, see GreyLevels; equal for both cameras
};

/// A folder of image pairs in one of these layouts:
/// - KITTI's odometry (image_0 and image_1, or image_2 and image_3, with calib.txt and times.txt, or
/// times_0.txt
///   and times_1.txt, which take precedence), or other subfolders of numbered images, see findImageSubfolders
/// - KITTI's raw recordings (image_00/data, image_01/data, each with timestamps.txt)
/// - EuRoC's (mav0/cam0, mav0/cam1)
struct ImageFolder {
  FolderLayout layout = FolderLayout::kitti;
  std::filesystem::path folder;  ///< the folder that contains image_0 (KITTI) or cam0 (EuRoC)
  ImageSequence left;
  ImageSequence right;
  std::vector<std::string> warnings;  ///< about images and instants that are unusual

  // Files with the calibration of the rig; empty if there is none.
  std::filesystem::path calib_file;                   ///< KITTI's calib.txt, or calib_cam_to_cam.txt (raw)
  std::array<int, 2> cameras{0, 1};                   ///< numbers of the cameras in `calib_file`
  std::filesystem::path rig_file;                     ///< rig.yaml in the folder
  std::array<std::filesystem::path, 2> sensor_files;  ///< EuRoC's sensor.yaml, left and right
};

struct ImageFolderSettings {
  /// Frame rate, Hz, that replaces times.txt: instants are the images' numbers divided by it, or their places
  /// in the order of the names if these are not numbers. 0: none.
  double frame_rate = 0.0;
};

/// Detects the layout by the subfolders; does not check their files. Nothing if it is none of them.
std::optional<FolderLayout> detectImageFolder(const std::filesystem::path& folder);

/// Reads the image lists and instants, and a sample of the images. KITTI's instants are converted from
/// seconds, EuRoC's are ns as written. Throws std::runtime_error naming the file and line if a file is
/// missing, left and right images do not correspond by name (where they share times.txt), counts differ,
/// instants do not increase, or their intervals are not those of a camera.
ImageFolder readImageFolder(const std::filesystem::path& folder, const ImageFolderSettings& settings = {});

/// Median time between the frames, ns; 0 if there is only one.
std::int64_t nominalPeriodNs(const ImageSequence& sequence);

/// Frames of one camera of an image folder, without real-time pacing.
class ImageSequenceSource : public CameraSource {
 public:
  explicit ImageSequenceSource(ImageSequence sequence);

  /// Never waits. Throws std::runtime_error naming the file if an image cannot be read or its size differs
  /// from the first one's.
  ReadOutcome read(Frame& frame, std::chrono::milliseconds timeout) override;
  CameraHealth health() const override;
  void interrupt() noexcept override { interrupted_ = true; }

 private:
  ImageSequence sequence_;
  cv::Size size_;
  std::atomic<std::uint64_t> next_ = 0;
  std::atomic<bool> interrupted_ = false;
};

}  // namespace cartvo::capture
