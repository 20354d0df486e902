#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "capture/camera_source.hpp"

// Image folders of the KITTI and EuRoC data sets as frame sources.

namespace cartvo::capture {

/// Layout of an image folder.
enum class FolderLayout : std::uint8_t { kitti, euroc };

/// One camera's image files, in the order of their exposure.
struct ImageSequence {
  std::vector<std::filesystem::path> images;
  std::vector<std::int64_t> instants_ns;  ///< of exposure, strictly increasing; one per image
  std::int64_t stddev_ns = 0;             ///< standard deviation of the instants
};

/// Intrinsics and baseline of a rectified pair, from P0 and P1 of a KITTI calib.txt.
struct RectifiedStereo {
  double focal_length = 0.0;  ///< px
  double cx = 0.0, cy = 0.0;  ///< principal point, px
  double right_cx = 0.0;      ///< the right camera's, px; equal to cx in KITTI's own files
  double baseline = 0.0;      ///< m, positive
};

/// A folder of image pairs in KITTI's odometry layout (image_0, image_1, calib.txt, times.txt, or times_0.txt
/// and times_1.txt, which take precedence) or in EuRoC's (mav0/cam0, mav0/cam1).
struct ImageFolder {
  FolderLayout layout = FolderLayout::kitti;
  std::filesystem::path folder;  ///< the folder that contains image_0 (KITTI) or cam0 (EuRoC)
  ImageSequence left;
  ImageSequence right;

  // Calibration of the rig; capture only passes it on.
  std::optional<RectifiedStereo> rectified;           ///< from calib.txt
  std::filesystem::path calib_file;                   ///< KITTI's calib.txt; empty if there is none
  std::filesystem::path rig_file;                     ///< rig.yaml in the folder; empty if there is none
  std::array<std::filesystem::path, 2> sensor_files;  ///< EuRoC's sensor.yaml, left and right; may be empty
};

/// Detects the layout by the subfolders; does not check their files. Nothing if it is neither layout.
std::optional<FolderLayout> detectImageFolder(const std::filesystem::path& folder);

/// Reads the image lists and instants, not the images. KITTI's instants are converted from seconds, EuRoC's
/// are ns as written. Throws std::runtime_error naming the file and line if a file is missing, counts differ,
/// or instants do not increase.
ImageFolder readImageFolder(const std::filesystem::path& folder);

/// Reads an image as grey, CV_8UC1. Throws std::runtime_error naming the file if it cannot be decoded.
cv::Mat readGreyImage(const std::filesystem::path& file);

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
