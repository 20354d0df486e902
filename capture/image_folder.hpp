#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "capture/camera_source.hpp"

namespace cartvo {

enum class FolderLayout : std::uint8_t { kitti, euroc };

/// One camera's images on disk, in the order of their exposure.
struct ImageSequence {
  std::vector<std::filesystem::path> images;
  std::vector<std::int64_t> instants_ns;  ///< of exposure, strictly increasing; as many as images
  std::int64_t deviation_ns = 0;          ///< standard deviation of these
};

/// What P0 and P1 of a KITTI calib.txt say of rectified cameras, which share all but the baseline.
struct RectifiedStereo {
  double focal_length = 0.0;  ///< px
  double cx = 0.0, cy = 0.0;  ///< principal point, px
  double right_cx = 0.0;      ///< the right camera's, px; equal to cx in KITTI's own files
  double baseline = 0.0;      ///< m, positive: the right camera is to the right
};

/// A folder of image pairs in KITTI's odometry layout (image_0, image_1, calib.txt, times.txt, or times_0.txt
/// and times_1.txt, which take precedence) or in EuRoC's (mav0/cam0, mav0/cam1).
struct ImageFolder {
  FolderLayout layout = FolderLayout::kitti;
  std::filesystem::path folder;  ///< that holds image_0 (KITTI), or cam0 (EuRoC)
  ImageSequence left;
  ImageSequence right;

  // What is said of the rig; capture only passes it on.
  std::optional<RectifiedStereo> rectified;           ///< from calib.txt
  std::filesystem::path calib_file;                   ///< KITTI's calib.txt; empty if there is none
  std::filesystem::path rig_file;                     ///< rig.yaml in the folder; empty if there is none
  std::array<std::filesystem::path, 2> sensor_files;  ///< EuRoC's sensor.yaml, left and right; or empty
};

/// Whether the folder looks like one of the layouts (its files may still be wrong).
std::optional<FolderLayout> detectImageFolder(const std::filesystem::path& folder);

/// Reads the lists and instants, not the images. KITTI's instants are seconds from 0, EuRoC's are ns as
/// written. Throws std::runtime_error naming the file, and the line, for anything missing, unequal counts, or
/// instants that do not increase.
ImageFolder readImageFolder(const std::filesystem::path& folder);

/// The image as grey. Throws std::runtime_error naming the file if it is not one.
cv::Mat readGreyImage(const std::filesystem::path& file);

/// Median time between the frames, ns; 0 if there is only one.
std::int64_t nominalPeriodNs(const ImageSequence& sequence);

/// Plays one camera of an image folder, as fast as it is read.
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

}  // namespace cartvo
