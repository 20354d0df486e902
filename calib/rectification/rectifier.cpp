// Rectification of images through lookup tables.
#include "calib/rectification/rectifier.hpp"

#include <cstddef>
#include <stdexcept>
#include <utility>

#include <opencv2/core/mat.hpp>

#include "calib/model/static_mask.hpp"
#include "calib/rectification/rectification_tables.hpp"
#include "calib/rectification/remap.hpp"
#include "common/image_size.hpp"

namespace cartvo::calib {
namespace {

// Rectification of masks.

/// The mask as it lies in the rectified image: 0 where one of the four raw pixels that the rectified one is
/// interpolated from must not be used, 255 elsewhere; empty for an empty mask. `sources`: of images of the
/// mask's size; empty if the images are already rectified.
cv::Mat rectifiedMask(const StaticMask& mask, const PixelSources& sources) {
  if (mask.empty() || sources.column.empty()) return mask.used;
  const cv::Mat& used = mask.used;
  cv::Mat rectified(used.size(), CV_8UC1);
  std::size_t i = 0;
  for (unsigned char& pixel : cv::Mat_<unsigned char>(rectified)) {
    const int x = sources.column[i], y = sources.row[i];
    const bool all_used = *used.ptr(y, x) != 0 && *used.ptr(y, x + 1) != 0 && *used.ptr(y + 1, x) != 0 &&
                          *used.ptr(y + 1, x + 1) != 0;
    pixel = all_used ? 255 : 0;
    ++i;
  }
  return rectified;
}

}  // namespace

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
