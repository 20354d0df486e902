#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "capture/encoded_unit.hpp"

namespace cartvo::test {

/// Textured picture that moves with its index.
cv::Mat movingPicture(cv::Size size, int index);

/// Encodes pictures 0 to count-1 as a camera does: no B-frames, a key frame every `key_interval`, parameter
/// sets in each key frame. Exposure instants are 50 ms apart. `encoder_options`: "key=value:key=value" of
/// libx264 or libx265. With `b_frames` the pictures are in the order of encoding, and their instants are not.
std::vector<capture::EncodedUnit> encodeSequence(capture::VideoCodec codec, cv::Size size, int count,
                                                 int key_interval, const std::string& encoder_options,
                                                 int b_frames = 0);

/// FNV-1a hash of an image's pixels.
std::uint64_t digest(const cv::Mat& image);

/// Digests of the pictures of an undamaged stream.
std::set<std::uint64_t> digestsOf(capture::VideoCodec codec, const std::vector<capture::EncodedUnit>& units);

}  // namespace cartvo::test
