#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

namespace cartvo::calib {

/// Parts of a camera's raw image that never show the scene, such as the roof edge, a pillar or lettering.
/// Landmarks there are never used.
struct StaticMask {
  using Polygon = std::vector<cv::Point>;

  /// CV_8UC1 of the size of the raw image: 0 where it must not be used, 255 where it may. Empty: all of it
  /// may. Shared by copies, not to be changed.
  cv::Mat used;
  // Where `used` comes from: polygons in px of the raw image, their edges included, or an image file. None of
  // both: an image within the rig file.
  std::vector<Polygon> polygons;
  std::filesystem::path file;

  bool empty() const { return used.empty(); }
};

/// Share of the image that must not be used, in [0, 1].
double maskedShare(const StaticMask& mask);

/// The mask of a part of the image; empty for an empty mask.
StaticMask maskOfPart(const StaticMask& mask, const cv::Rect& part);

/// The mask of an image of this size that leaves out the polygons.
StaticMask maskOfPolygons(std::vector<StaticMask::Polygon> polygons, cv::Size size);

/// Lens model; see BrownDistortion and WideDistortion.
enum class LensModel : std::uint8_t {
  brown,  ///< pinhole with Brown's distortion (thesis 4.5-4.7): k1 k2 p1 p2 k3 k4 k5 k6, as in OpenCV
  wide,   ///< Kannala and Brandt's fisheye: k1 k2 k3 k4, then zeros, as in OpenCV's fisheye module
};

/// Intrinsics of a camera, its shutter, and what of its image is used.
struct CameraModel {
  cv::Size size;                                  ///< image size that the model is valid for, px
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  ///< px; pixel centres at integer coordinates
  LensModel lens = LensModel::brown;
  std::array<double, 8> distortion{};  ///< the lens model's coefficients
  /// s, mid-exposure of the lower edge of the raw image minus that of its upper edge: rows times line time.
  /// Negative if the rows are exposed from bottom to top, 0: a global shutter, empty: unknown.
  std::optional<double> readout;
  StaticMask mask;  ///< parts of the raw image that are not used
};

/// Number of coefficients of a lens model. They are the first ones of CameraModel::distortion.
std::size_t distortionCount(LensModel lens);

/// Whether the camera is a pinhole without distortion.
bool isPinhole(const CameraModel& camera);

/// Settings of the rectification.
struct RectificationSettings {
  /// Share of the raw images that is kept, like cv::stereoRectify's alpha: 0 crops until every rectified
  /// pixel has a source, 1 shrinks until no raw pixel is lost.
  double free_scaling = 0.0;
};

/// Calibration of a stereo rig: both cameras, their relative pose, and the pose of the left camera on the
/// cart.
struct Rig {
  std::string name;
  CameraModel left;
  CameraModel right;
  Eigen::Isometry3d T_right_left =
      Eigen::Isometry3d::Identity();  ///< left camera axes to right camera axes, m
  Eigen::Isometry3d T_body_camera =
      Eigen::Isometry3d::Identity();  ///< left camera axes to body axes (REP-103), m
  RectificationSettings rectification;
  /// Relative standard deviation of the baseline, which scales all lengths that the rig measures. 0: unknown,
  /// counts as exact.
  double scale_stddev = 0.0;
  /// A person has confirmed what unusualGeometry() reports.
  bool unusual_geometry = false;

  /// Distance between the cameras, m.
  double baseline() const { return T_right_left.translation().norm(); }
};

/// Whether the rig says how the cameras sit on the cart: false if the left camera's height above the body's
/// origin is 0, as in a rig that has no T_body_camera. Velocities are then those of the left camera.
bool hasMount(const Rig& rig);

/// Warning about a rig without a mount.
inline constexpr const char* kNoMountText =
    "how the cameras sit on the cart is not known (T_body_camera is missing or has height 0): velocities are "
    "the left camera's; run 'cartvo calibrate mount'";

/// T_body_camera of a camera that looks forward from the body's origin: camera axes (x right, y down, z
/// forward) to body axes (x forward, y left, z up). The default mount of a rig.
Eigen::Isometry3d forwardLookingMount();

}  // namespace cartvo::calib
