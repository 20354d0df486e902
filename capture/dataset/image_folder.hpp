#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "capture/camera_source.hpp"
#include "capture/dataset/grey_levels.hpp"
#include "capture/dataset/image_files.hpp"
#include "capture/dataset/picture_part.hpp"

// Image folders in the layouts of data sets as frame sources.

namespace cartvo::capture {

/// Layout of an image folder.
enum class FolderLayout : std::uint8_t { kitti, kitti_raw, euroc, lists, one_folder };

/// The layouts that are recognised, for messages.
inline constexpr const char* kLayouts =
    "KITTI's layout (image_0 and image_1, or image_2 and image_3, image_left and image_right, left and "
    "right; "
    "with times.txt or instants in the names), KITTI's raw recordings (image_00/data, image_01/data, "
    "timestamps.txt), EuRoC's and TUM-VI's layout (cam0 and cam1, in it or in mav0), lists of images "
    "(left.txt and right.txt, or cam0.txt and cam1.txt), and images of both cameras in one folder (in it, "
    "StereoImages, Images or NAME_Images) that have left and right, L and R, I1 and I2, or cam0 and cam1 in "
    "their names; give --side-by-side for images with both cameras' pictures beside each other";

/// One camera's image files, in the order of their exposure.
struct ImageSequence {
  std::vector<std::filesystem::path> images;
  std::vector<std::int64_t> instants_ns;  ///< of exposure, strictly increasing; one per image
  std::int64_t stddev_ns = 0;             ///< standard deviation of the instants
  GreyRange grey_range;                   ///< of 16-bit images, see GreyLevels
  PicturePart part = PicturePart::whole;  ///< of each image
};

/// A folder of image pairs in one of these layouts:
/// - KITTI's odometry (image_0 and image_1, or image_2 and image_3, with calib.txt), or other subfolders of
///   images, see findImageSubfolders; instants as readInstants finds them: times.txt, or in the names
/// - KITTI's raw recordings (image_00/data, image_01/data, each with timestamps.txt)
/// - EuRoC's (mav0/cam0, mav0/cam1), and TUM-VI's, which has the rig in dso/camchain.yaml
/// - lists: left.txt and right.txt, each line an instant and an image
/// - one folder with the images of both cameras, told apart by their names (New College, Malaga, Karlsruhe,
///   exported SVO files of a ZED), or with both pictures side by side in each image
struct ImageFolder {
  FolderLayout layout = FolderLayout::kitti;
  std::filesystem::path folder;  ///< the folder that contains image_0 (KITTI) or cam0 (EuRoC)
  ImageSequence left;
  ImageSequence right;
  std::vector<std::string> warnings;  ///< about images and instants that are unusual

  // Files with the calibration of the rig; empty if there is none.
  /// KITTI's calib.txt, calib_cam_to_cam.txt (raw), or TUM-VI's camchain.yaml.
  std::filesystem::path calib_file;
  std::array<int, 2> cameras{0, 1};                   ///< numbers of the cameras in `calib_file`
  std::filesystem::path rig_file;                     ///< rig.yaml in the folder
  std::array<std::filesystem::path, 2> sensor_files;  ///< EuRoC's sensor.yaml, left and right
};

struct ImageFolderSettings {
  /// Frame rate, Hz, that replaces times.txt or instants in names: instants are the images' numbers divided
  /// by it, or their places in the order of the names if these are not numbers. 0: none.
  double frame_rate = 0.0;

  /// Each image contains both cameras' pictures, the left camera's in the left half.
  bool side_by_side = false;
};

/// Detects the layout by the subfolders; does not check their files. Nothing if it is none of them.
std::optional<FolderLayout> detectImageFolder(const std::filesystem::path& folder);

/// Reads the image lists and instants, and a sample of the images. KITTI's instants are converted from
/// seconds, EuRoC's are ns as written. Both cameras may have different numbers of images where each has
/// instants of its own. Throws std::runtime_error naming the file and line if a file is
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
