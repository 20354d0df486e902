#pragma once

#include <filesystem>
#include <vector>

#include <opencv2/core/mat.hpp>

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

}  // namespace cartvo::calib
