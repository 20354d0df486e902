#pragma once

#include <string>

#include <opencv2/core/mat.hpp>

#include "calib/rectification.hpp"
#include "calib/rectification_tables.hpp"
#include "calib/rig.hpp"

namespace cartvo {

/// Turns raw images into rectified ones. Immutable: any number of threads may use one at a time.
class Rectifier {
 public:
  /// The tables must be this rig's, see loadOrBuildTables or buildTables; throws std::invalid_argument
  /// otherwise.
  Rectifier(const Rig& rig, const RectificationSettings& settings, RectificationTables tables);

  const Rectification& rectification() const { return rectification_; }

  /// Rectifies a raw image (CV_8UC1) of the left or right camera. `rectified` is reused if it has the right
  /// size and type and is no view of `raw`. A rig that is rectified already gets `raw` itself, without a
  /// copy. Throws std::runtime_error for an image of another size than the rig's, stating both sizes and what
  /// to do.
  void rectifyLeft(const cv::Mat& raw, cv::Mat& rectified) const;
  void rectifyRight(const cv::Mat& raw, cv::Mat& rectified) const;

 private:
  void rectify(const char* side, const PixelSources& sources, const cv::Mat& raw, cv::Mat& rectified) const;

  std::string rig_name_;
  Rectification rectification_;
  RectificationTables tables_;
};

}  // namespace cartvo
