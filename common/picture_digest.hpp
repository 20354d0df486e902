#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

namespace cartvo {

/// Digest of every eighth row of an image (CV_8UC1): equal for equal images, different for the next image of
/// a camera or that of another camera, whose noise differs.
std::uint64_t pictureDigest(const cv::Mat& image);
/// The same without the pixels at which `mask` (CV_8UC1 of the same size) is zero. An empty mask has none.
std::uint64_t pictureDigest(const cv::Mat& image, const cv::Mat& mask);

/// True if most pixels of these rows equal their left neighbour, as in the image of a covered camera. Such
/// images may be equal by chance.
bool isUniform(const cv::Mat& image);

}  // namespace cartvo
