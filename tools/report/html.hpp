#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace cartvo {

/// Text with the special characters of HTML escaped.
std::string escaped(std::string_view text);

/// An image element with the image embedded as PNG.
std::string imageElement(const cv::Mat& image, std::string_view description);

/// A table element; all cells are escaped.
std::string tableElement(const std::vector<std::string>& header,
                         const std::vector<std::vector<std::string>>& rows);

/// The time of a report: now, "2026-11-30 02:15:00 UTC".
std::string reportTime();

/// A page for light and dark screens of any width. `title` is escaped; `style`: CSS rules after the common
/// ones; `body`: HTML.
std::string htmlPage(std::string_view title, std::string_view style, std::string_view body);

}  // namespace cartvo
