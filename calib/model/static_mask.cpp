// Masks from polygons, and their share of the image.
#include "calib/model/static_mask.hpp"

#include <utility>

#include <opencv2/imgproc.hpp>

namespace cartvo::calib {

double maskedShare(const StaticMask& mask) {
  if (mask.empty()) return 0.0;
  return 1.0 - static_cast<double>(cv::countNonZero(mask.used)) / static_cast<double>(mask.used.total());
}

StaticMask maskOfPart(const StaticMask& mask, const cv::Rect& part) {
  StaticMask cut;
  if (!mask.empty()) cut.used = mask.used(part).clone();
  return cut;
}

StaticMask maskOfPolygons(std::vector<StaticMask::Polygon> polygons, cv::Size size) {
  StaticMask mask;
  mask.used = cv::Mat(size, CV_8UC1, cv::Scalar(255));
  for (const StaticMask::Polygon& polygon : polygons)
    cv::fillPoly(mask.used, std::vector<StaticMask::Polygon>{polygon}, cv::Scalar(0));
  mask.polygons = std::move(polygons);
  return mask;
}

}  // namespace cartvo::calib
