#pragma once

#include <optional>

#include <opencv2/core/mat.hpp>

#include "pipeline/picture_light.hpp"

namespace cartvo::doctor {

/// Light and sharpness of a picture.
struct PictureMeasures : pipeline::PictureLight {
  std::optional<double> sharpness;  ///< see sharpnessOf
};

/// Ratio of the squared gradients (per px of each) of a picture to those of its half: about 0.25 if it is
/// blurred over many pixels, and more, the finer its edges are. Contrast and light cancel. Nothing if the
/// picture (CV_8UC1) shows no edges. `used`: as measurePicture's.
std::optional<double> sharpnessOf(const cv::Mat& picture, const cv::Mat& used);

/// Part of the sharpness beyond that of a blurred picture, positive.
double excessSharpness(double sharpness);

/// Measures a picture (CV_8UC1) where `used` (CV_8UC1 of the same size, may be empty: everywhere) is not 0.
PictureMeasures measurePicture(const cv::Mat& picture, const cv::Mat& used);

}  // namespace cartvo::doctor
