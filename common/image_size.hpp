#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <opencv2/core/types.hpp>

namespace cartvo {

/// An image size as text, such as "680x420".
std::string sizeText(const cv::Size& size);

/// Parses such text: two integers from 1 to 99999 without signs, spaces or leading zeros. std::nullopt for
/// other text.
std::optional<cv::Size> parseImageSize(std::string_view text);

}  // namespace cartvo
