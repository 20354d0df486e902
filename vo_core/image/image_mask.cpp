// Growth of masked regions by the patches of landmarks.
#include "vo_core/image/image_mask.hpp"

#include <opencv2/imgproc.hpp>

#include "vo_core/image/affine_alignment.hpp"
#include "vo_core/image/image_pyramid.hpp"

namespace cartvo::vo {

ImageMask::ImageMask(const cv::Mat& used) {
  if (used.empty()) return;
  for (int level = 0; level < kLandmarkLevels; ++level) {
    const auto side = static_cast<int>(kPatchSide * levelScale(level)) | 1;
    cv::erode(used, clear_[static_cast<std::size_t>(level)],
              cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  }
}

}  // namespace cartvo::vo
