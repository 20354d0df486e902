// Rectification of images through lookup tables, in fixed point.
#include "calib/rectification/rectifier.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <opencv2/core/mat.hpp>

#include "calib/model/rig.hpp"
#include "calib/rectification/rectification_tables.hpp"
#include "common/image_size.hpp"
#include "common/simd/bilinear_gather.hpp"

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

/// Source positions of sixteen pixels.
struct Positions {
  const std::uint16_t *column, *row;
  const std::uint8_t *column_fraction, *row_fraction;
};

/// Loads the 2x2 pixels at each position, one position at a time: the pixel, the one to its right, below, and
/// below to the right, lowest byte first.
void gatherPixels(const cv::Mat& source, const Positions& positions, IntLanes& pixels) {
  ShortLanes row, column;
  std::memcpy(&row, positions.row, sizeof row);
  std::memcpy(&column, positions.column, sizeof column);
  const auto stride = static_cast<int>(source.step[0]);
  const IntLanes offset =
      __builtin_convertvector(row, IntLanes) * stride + __builtin_convertvector(column, IntLanes);
  gather2x2Scalar(source.data, stride, offset, kLanes, pixels);
}

/// Interpolates bilinearly between the 2x2 pixels, exactly, and rounds once.
void interpolate(const IntLanes& pixels, const Positions& positions, std::uint8_t* target) {
  ShortLanes x16, y16;
  LaneOperations::load(positions.column_fraction, x16);
  LaneOperations::load(positions.row_fraction, y16);
  const IntLanes x = __builtin_convertvector(x16, IntLanes), y = __builtin_convertvector(y16, IntLanes);
  // Interpolate along the rows: a pair of values for each position, above and below.
  const IntLanes x_of_both = x | x << 16, left_bytes = pixels & 0x00ff00ff;
  const WideShorts &both = reinterpret_cast<const WideShorts&>(pixels),
                   &left = reinterpret_cast<const WideShorts&>(left_bytes),
                   &share = reinterpret_cast<const WideShorts&>(x_of_both);
  const WideShorts between = (both << 8) + share * ((both >> 8) - left);  // modulo 2^16
  IntLanes sum;
  LaneOperations::blendRows(reinterpret_cast<const IntLanes&>(between), y << 8, sum);
  LaneOperations::storeBytes((sum + (1 << 15)) >> 16, target);
}

void remapSixteen(const cv::Mat& source, const Positions& positions, std::uint8_t* target) {
  IntLanes pixels;
  gatherPixels(source, positions, pixels);
  interpolate(pixels, positions, target);
}

/// Remaps the last `count` pixels of a row, padded to sixteen with copies of the last position.
void remapRest(const cv::Mat& source, const Positions& positions, int count, std::uint8_t* target) {
  std::array<std::uint16_t, kLanes> column, row;
  std::array<std::uint8_t, kLanes> x, y, blended;
  for (int i = 0; i < kLanes; ++i) {
    const int from = std::min(i, count - 1);
    column[i] = positions.column[from];
    row[i] = positions.row[from];
    x[i] = positions.column_fraction[from];
    y[i] = positions.row_fraction[from];
  }
  remapSixteen(source, {column.data(), row.data(), x.data(), y.data()}, blended.data());
  std::copy_n(blended.data(), count, target);
}

CARTVO_TARGET_CLONES void remapHere(const cv::Mat& source, const PixelSources& sources, cv::Mat& target) {
  for (int row = 0; row < target.rows; ++row) {
    std::uint8_t* const out = target.ptr<std::uint8_t>(row);
    const std::size_t first = static_cast<std::size_t>(row) * target.cols;
    for (int column = 0; column < target.cols; column += kLanes) {
      const std::size_t at = first + column;
      const Positions positions{sources.column.data() + at, sources.row.data() + at,
                                sources.column_fraction.data() + at, sources.row_fraction.data() + at};
      if (const int count = target.cols - column; count < kLanes)
        remapRest(source, positions, count, out + column);
      else
        remapSixteen(source, positions, out + column);
    }
  }
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

void remap(const cv::Mat& source, const PixelSources& sources, cv::Mat& target) {
  remapHere(source, sources, target);
}

}  // namespace cartvo::calib
