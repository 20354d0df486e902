#pragma once

#include <string>

#include <opencv2/core/mat.hpp>

#include "calib/model/rig.hpp"
#include "calib/rectification/rectification.hpp"
#include "calib/rectification/rectification_tables.hpp"

namespace cartvo::calib {

/// Rectifies images. Immutable, so several threads may use one object at the same time.
class Rectifier {
 public:
  /// Throws std::invalid_argument unless `tables` are those of this rig and these settings, see
  /// loadOrBuildTables, and its masks have the size of the images.
  Rectifier(const Rig& rig, const RectificationSettings& settings, RectificationTables tables);

  const Rectification& rectification() const { return rectification_; }

  /// The masks of the rig as they lie in the rectified images: 0 where a pixel is interpolated from one that
  /// must not be used, 255 elsewhere. Empty without a mask.
  const cv::Mat& leftMask() const { return left_mask_; }
  const cv::Mat& rightMask() const { return right_mask_; }

  /// Rectifies a raw image (CV_8UC1) of the left or right camera. The memory of `rectified` is reused if it
  /// has the right size and type and is not shared with `raw`. If the rig is already rectified, the result is
  /// `raw` without a copy. Throws std::runtime_error for an image of another size or type, stating both sizes
  /// and what to do.
  void rectifyLeft(const cv::Mat& raw, cv::Mat& rectified) const;
  void rectifyRight(const cv::Mat& raw, cv::Mat& rectified) const;

 private:
  void rectify(const char* side, const PixelSources& sources, const cv::Mat& raw, cv::Mat& rectified) const;

  std::string rig_name_;
  Rectification rectification_;
  RectificationTables tables_;
  cv::Mat left_mask_, right_mask_;  ///< never written after construction
};

/// Fills `target` (CV_8UC1) with the grey values of `source` at the positions of the table, by bilinear
/// interpolation with weights of 1/256, rounded once to the nearest integer. `sources` must contain one
/// position within `source` for each pixel of `target` (see PixelSources); this is not checked.
void remap(const cv::Mat& source, const PixelSources& sources, cv::Mat& target);

}  // namespace cartvo::calib
