#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace cartvo {

/// Text as HTML shows it.
std::string escaped(std::string_view text);

/// An image as a PNG within the page.
std::string imageElement(const cv::Mat& image, std::string_view description);

/// A table; all cells are escaped.
std::string tableElement(const std::vector<std::string>& header,
                         const std::vector<std::vector<std::string>>& rows);

}  // namespace cartvo
