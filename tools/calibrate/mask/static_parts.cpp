// Static parts from the mean of normalised gradients.
#include "tools/calibrate/mask/static_parts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include <opencv2/imgproc.hpp>

#include "common/statistics.hpp"

namespace cartvo::calibrate {
namespace {

constexpr std::int64_t kInterval_ns = 250'000'000;  // at walking speed a picture changes in this time
// Grey values per px. The least contrast of a corner is 6 grey values, over about two pixels.
constexpr float kWeakGradient = 3.0F;
// Length of the mean edge above which it is static: it is there in more than half of the pictures. By chance,
// 30 edges of random directions have a mean of 0.15.
constexpr float kStaticMean = 0.5F;
constexpr float kTexturedMean = 0.25F;  // mean length of the edges of what has texture
// Correlation with the last picture below which a block has changed.
constexpr double kChangedCorrelation = 0.5;
constexpr int kBlockColumns = 8, kBlockRows = 6;
// Sizes in px. No patch of a landmark fits between parts that are closer than its 15 px. What is smaller than
// one may be a pole at the end of a straight road.
constexpr int kPatchSide = 15;
constexpr int kMinArea = kPatchSide * kPatchSide;
constexpr int kMargin = 2;  // that the interpolation and the codec blur

/// Gradients g as g / (|g| + kWeakGradient): of a length below 1 that hardly depends on contrast and light.
cv::Mat edgesOf(const cv::Mat& picture) {
  constexpr double kSobelScale = 1.0 / 8.0;
  cv::Mat x, y;
  cv::Sobel(picture, x, CV_32F, 1, 0, 3, kSobelScale);
  cv::Sobel(picture, y, CV_32F, 0, 1, 3, kSobelScale);
  cv::Mat edges;
  cv::merge(std::vector<cv::Mat>{x, y}, edges);
  for (cv::Vec2f& edge : cv::Mat_<cv::Vec2f>(edges))
    edge /= std::hypot(edge[0], edge[1]) + kWeakGradient;
  return edges;
}

cv::Mat lengthsOf(const cv::Mat& edges) {
  std::vector<cv::Mat> parts;
  cv::split(edges, parts);
  cv::Mat lengths;
  cv::magnitude(parts[0], parts[1], lengths);
  return lengths;
}

/// Whether at least half of the blocks with texture have changed.
bool hasChanged(const cv::Mat& before, const cv::Mat& now) {
  std::vector<double> correlations;
  for (int row = 0; row < kBlockRows; ++row) {
    for (int column = 0; column < kBlockColumns; ++column) {
      const cv::Point from(column * now.cols / kBlockColumns, row * now.rows / kBlockRows);
      const cv::Point to((column + 1) * now.cols / kBlockColumns, (row + 1) * now.rows / kBlockRows);
      const cv::Mat a = before(cv::Rect(from, to)), b = now(cv::Rect(from, to));
      const double squares = std::max(a.dot(a), b.dot(b));  // of the sharper one: the other may be blank
      if (squares < kTexturedMean * kTexturedMean * static_cast<double>(b.total())) continue;
      correlations.push_back(a.dot(b) / squares);
    }
  }
  return !correlations.empty() && median(correlations) < kChangedCorrelation;
}

std::string percent(double share) {
  return std::to_string(std::lround(100.0 * share)) + " %";
}

/// Joins static edges to parts, without specks. CV_8UC1: 255 in the parts.
cv::Mat partsOf(const cv::Mat& static_edges, std::vector<cv::Rect>& boxes) {
  const auto square = [](int side) { return cv::getStructuringElement(cv::MORPH_RECT, {side, side}); };
  cv::Mat joined, labels, statistics, centres;
  cv::morphologyEx(static_edges, joined, cv::MORPH_CLOSE, square(kPatchSide));
  const int count = cv::connectedComponentsWithStats(joined, labels, statistics, centres);
  cv::Mat parts = cv::Mat::zeros(joined.size(), CV_8UC1);
  for (int i = 1; i < count; ++i) {  // 0 is the background
    if (statistics.at<int>(i, cv::CC_STAT_AREA) < kMinArea) continue;
    parts.setTo(255, labels == i);
    boxes.emplace_back(statistics.at<int>(i, cv::CC_STAT_LEFT), statistics.at<int>(i, cv::CC_STAT_TOP),
                       statistics.at<int>(i, cv::CC_STAT_WIDTH), statistics.at<int>(i, cv::CC_STAT_HEIGHT));
  }
  std::sort(boxes.begin(), boxes.end(),
            [](const cv::Rect& a, const cv::Rect& b) { return a.area() > b.area(); });
  cv::dilate(parts, parts, square(2 * kMargin + 1));
  return parts;
}

}  // namespace

void StaticPartFinder::add(const cv::Mat& picture, std::int64_t time_ns) {
  if (pictures_ > 0 && std::abs(time_ns - last_time_ns_) < kInterval_ns) return;
  cv::Mat edges = edgesOf(picture);
  if (pictures_ == 0) {
    sum_ = cv::Mat::zeros(edges.size(), CV_32FC2);
    size_sum_ = cv::Mat::zeros(edges.size(), CV_32FC1);
  } else {
    if (edges.size() != last_.size()) throw std::runtime_error("the size of the pictures changes");
    if (!hasChanged(last_, edges)) return;
  }
  sum_ += edges;
  size_sum_ += lengthsOf(edges);
  last_ = std::move(edges);
  last_time_ns_ = time_ns;
  ++pictures_;
}

StaticParts StaticPartFinder::result() const {
  if (pictures_ < kMinPictures) {
    throw std::runtime_error("pictures that differ from the one before: " + std::to_string(pictures_) +
                             ", needed: " + std::to_string(kMinPictures) +
                             "; drive for a minute, with curves, through surroundings with texture");
  }
  const auto count = static_cast<float>(pictures_);
  const cv::Mat static_edges = lengthsOf(sum_) > kStaticMean * count;
  const cv::Mat textured = size_sum_ > kTexturedMean * count;
  const auto share_of = [](const cv::Mat& part, double all) { return cv::countNonZero(part) / all; };
  const double of_texture = share_of(static_edges, std::max(1, cv::countNonZero(textured)));
  if (of_texture > kMaxStaticShare) {
    throw std::runtime_error(percent(of_texture) +
                             " of what has texture keeps its place: did the cart stand? Drive for a minute, "
                             "with curves");
  }
  StaticParts found;
  const cv::Mat parts = partsOf(static_edges, found.boxes);
  found.pictures = pictures_;
  found.share = share_of(parts, static_cast<double>(parts.total()));
  if (found.share > kMaxStaticShare) {
    throw std::runtime_error(percent(found.share) +
                             " of the picture keeps its place, more than half of it: turn the camera so that "
                             "it sees more of the road");
  }
  found.used = 255 - parts;
  return found;
}

}  // namespace cartvo::calibrate
