#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <opencv2/core/types.hpp>

namespace cartvo {

/// As people write an image's size: "680x420".
std::string sizeText(const cv::Size& size);

/// What such text says: two whole numbers from 1 to 99999 without signs, spaces or leading zeros. Nothing if
/// it is other text.
std::optional<cv::Size> sizeFrom(std::string_view text);

}  // namespace cartvo
