// Rectification of images through lookup tables.
#include "calib/rectification/rectifier.hpp"

#include <stdexcept>
#include <utility>

#include "calib/rectification/rectified_mask.hpp"
#include "calib/rectification/remap.hpp"
#include "common/image_size.hpp"

namespace cartvo::calib {

Rectifier::Rectifier(const Rig& rig, const RectificationSettings& settings, RectificationTables tables)
    : rig_name_(rig.name), rectification_(computeRectification(rig, settings)), tables_(std::move(tables)) {
  if (tables_.size != rectification_.size || tables_.fingerprint != tablesFingerprint(rig, settings)) {
    throw std::invalid_argument("rectifier: the tables are not those of rig '" + rig.name + "'");
  }
  for (const CameraModel* camera : {&rig.left, &rig.right}) {
    if (!camera->mask.empty() && camera->mask.used.size() != rectification_.size)
      throw std::invalid_argument("rectifier: a mask of rig '" + rig.name + "' has another size");
  }
  left_mask_ = rectifiedMask(rig.left.mask, tables_.left);
  right_mask_ = rectifiedMask(rig.right.mask, tables_.right);
}

void Rectifier::rectifyLeft(const cv::Mat& raw, cv::Mat& rectified) const {
  rectify("left", tables_.left, raw, rectified);
}

void Rectifier::rectifyRight(const cv::Mat& raw, cv::Mat& rectified) const {
  rectify("right", tables_.right, raw, rectified);
}

void Rectifier::rectify(const char* side, const PixelSources& sources, const cv::Mat& raw,
                        cv::Mat& rectified) const {
  if (raw.size() != rectification_.size) {
    throw std::runtime_error(std::string("the ") + side + " camera's images are " + sizeText(raw.size()) +
                             " but rig '" + rig_name_ + "' was calibrated at " +
                             sizeText(rectification_.size) + ": set the camera to " +
                             sizeText(rectification_.size) + ", or calibrate it at " + sizeText(raw.size()));
  }
  if (raw.type() != CV_8UC1) {
    throw std::runtime_error(std::string("the ") + side +
                             " camera's images are not grey with 8 bits per pixel");
  }
  if (rectification_.is_identity) {
    rectified = raw;
    return;
  }
  if (rectified.datastart == raw.datastart) rectified.release();
  rectified.create(raw.size(), CV_8UC1);
  remap(raw, sources, rectified);
}

}  // namespace cartvo::calib
