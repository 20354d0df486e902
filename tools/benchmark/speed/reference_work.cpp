// The reference of the speed benchmark: remap, pyramids and KLT of OpenCV.
#include "tools/benchmark/speed/reference_work.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <string>
#include <utility>

#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace cartvo::benchmark {
namespace {

constexpr std::size_t kMaxSteps = 50;
constexpr int kPoints = 1000;
constexpr int kWindowSide = 21;  // px
constexpr int kLevels = 4;       // of the pyramid, including the image itself
constexpr double kMapShift = 2;  // px, range of the displacement in the remap maps

/// Limits OpenCV to one thread while this object lives.
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

std::vector<cv::Point2f> cornersOf(const cv::Mat& image) {
  constexpr double kQuality = 1e-4;
  constexpr double kDistance = 5.0;  // px
  std::vector<cv::Point2f> points;
  cv::goodFeaturesToTrack(image, points, kPoints, kQuality, kDistance);
  return points;
}

}  // namespace

ReferenceWork::ReferenceWork(const std::vector<cv::Mat>& images) {
  if (images.size() < 2)
    throw std::invalid_argument("the reference work needs two images, got " + std::to_string(images.size()));
  const std::size_t all = images.size() - 1, count = std::min(all, kMaxSteps);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = i * all / count;
    Step step{images[at], images[at + 1], cornersOf(images[at])};
    if (step.points.size() == kPoints) steps_.push_back(std::move(step));
  }
  if (steps_.empty())
    throw std::invalid_argument(
        "the reference work tracks 1000 corners, and no image has as many; use images with more texture");
  const cv::Size size = images.front().size();
  cv::Mat map_x(size, CV_32FC1), map_y(size, CV_32FC1);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double across = static_cast<double>(x) / size.width, down = static_cast<double>(y) / size.height;
      map_x.at<float>(y, x) = static_cast<float>(x + kMapShift * (down - 0.5));
      map_y.at<float>(y, x) = static_cast<float>(y + kMapShift * (across - 0.5));
    }
  }
  cv::convertMaps(map_x, map_y, map_, map_fraction_, CV_16SC2);
}

ReferenceTimes ReferenceWork::run() const {
  const OneThread one_thread;
  const auto count = static_cast<double>(steps_.size());
  ReferenceTimes mean;
  for (const Step& step : steps_) {
    const ReferenceTimes times = timesOf(step);
    mean.remap += times.remap / count;
    mean.pyramids += times.pyramids / count;
    mean.klt += times.klt / count;
  }
  return mean;
}

ReferenceTimes ReferenceWork::timesOf(const Step& step) const {
  const cv::Size window(kWindowSide, kWindowSide);
  ReferenceTimes times;
  cv::Mat rectified;
  times.remap = millisecondsOf([&] {
    for (const cv::Mat& image : {step.before, step.after})
      cv::remap(image, rectified, map_, map_fraction_, cv::INTER_LINEAR);
  });
  std::vector<cv::Mat> pyramid;
  times.pyramids = millisecondsOf([&] {
    for (const cv::Mat& image : {step.before, step.after})
      cv::buildOpticalFlowPyramid(image, pyramid, window, kLevels - 1, /*withDerivatives=*/false);
  });
  std::vector<cv::Point2f> found;
  std::vector<unsigned char> status;
  const cv::TermCriteria until(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 30, 0.01);
  times.klt = millisecondsOf([&] {
    cv::calcOpticalFlowPyrLK(step.before, step.after, step.points, found, status, cv::noArray(), window,
                             kLevels - 1, until);
  });
  return times;
}

}  // namespace cartvo::benchmark
