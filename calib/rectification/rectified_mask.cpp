// Rectification of masks.
#include "calib/rectification/rectified_mask.hpp"

#include <cstddef>

namespace cartvo::calib {

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

}  // namespace cartvo::calib
