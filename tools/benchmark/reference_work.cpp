// The yardstick: OpenCV's remap, pyramids and KLT.
#include "tools/benchmark/reference_work.hpp"

#include <chrono>
#include <stdexcept>
#include <utility>

#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace cartvo::benchmark {
namespace {

constexpr int kPoints = 1000;
constexpr int kSide = 21;    // px
constexpr int kLevels = 4;   // of the pyramid, the image itself included
constexpr double kBend = 2;  // px, by which the maps bend the image at most

/// One thread for as long as this object lives.
class OneThread {
 public:
  OneThread() { cv::setNumThreads(1); }
  ~OneThread() { cv::setNumThreads(before_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int before_ = cv::getNumThreads();
};

template <typename Work>
double millisecondsOf(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

ReferenceWork::ReferenceWork(cv::Mat before, cv::Mat after)
    : before_(std::move(before)), after_(std::move(after)) {
  constexpr double kQuality = 1e-4;
  constexpr double kDistance = 5.0;  // px
  cv::goodFeaturesToTrack(before_, points_, kPoints, kQuality, kDistance);
  if (points_.size() < kPoints)
    throw std::invalid_argument("the reference's image has fewer corners than the reference follows");
  cv::Mat map_x(before_.size(), CV_32FC1), map_y(before_.size(), CV_32FC1);
  for (int y = 0; y < before_.rows; ++y) {
    for (int x = 0; x < before_.cols; ++x) {
      const double across = static_cast<double>(x) / before_.cols,
                   down = static_cast<double>(y) / before_.rows;
      map_x.at<float>(y, x) = static_cast<float>(x + kBend * (down - 0.5));
      map_y.at<float>(y, x) = static_cast<float>(y + kBend * (across - 0.5));
    }
  }
  cv::convertMaps(map_x, map_y, map_, map_fraction_, CV_16SC2);
}

ReferenceTimes ReferenceWork::run() const {
  const OneThread one_thread;
  const cv::Size window(kSide, kSide);
  ReferenceTimes times;
  cv::Mat rectified;
  times.remap = millisecondsOf([&] {
    for (const cv::Mat& image : {before_, after_})
      cv::remap(image, rectified, map_, map_fraction_, cv::INTER_LINEAR);
  });
  std::vector<cv::Mat> pyramid;
  times.pyramids = millisecondsOf([&] {
    for (const cv::Mat& image : {before_, after_})
      cv::buildOpticalFlowPyramid(image, pyramid, window, kLevels - 1, /*withDerivatives=*/false);
  });
  std::vector<cv::Point2f> found;
  std::vector<unsigned char> status;
  const cv::TermCriteria until(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 30, 0.01);
  times.klt = millisecondsOf([&] {
    cv::calcOpticalFlowPyrLK(before_, after_, points_, found, status, cv::noArray(), window, kLevels - 1,
                             until);
  });
  return times;
}

}  // namespace cartvo::benchmark
