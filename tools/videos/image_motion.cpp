// Measures the global motion of a camera's images: phase correlation, refined by least squares.
#include "tools/videos/image_motion.hpp"

#include <algorithm>
#include <chrono>

#include <opencv2/imgproc.hpp>

namespace cartvo {
namespace {

constexpr int kWidth = 128;  // px, width of the reduced image
constexpr int kRefinements = 4;
constexpr double kMaxStep = 2.0;  // px; a larger step means that the images do not overlap enough
constexpr double kMinTexture =
    1e-3;  // smallest determinant of the normal equations relative to the product of the diagonal
constexpr double kSideMargin = 0.1;
constexpr double kTopMargin = 0.15;  // cameras overlay the time at the top and their name at the bottom

cv::Mat cropAndReduce(const cv::Mat& image) {
  const cv::Rect middle(cvRound(kSideMargin * image.cols), cvRound(kTopMargin * image.rows),
                        cvRound((1.0 - 2.0 * kSideMargin) * image.cols),
                        cvRound((1.0 - 2.0 * kTopMargin) * image.rows));
  const int height = std::max(cvRound(static_cast<double>(kWidth) * middle.height / middle.width), 8);
  cv::Mat small;
  cv::resize(image(middle), small, {kWidth, height}, 0, 0, cv::INTER_AREA);
  small.convertTo(small, CV_32F);
  return small;
}

/// The shift of the second image relative to the first, px. Phase correlation finds it to a pixel, but is
/// biased towards zero below one pixel; Lucas-Kanade least squares on the grey values is not.
cv::Point2d estimateShift(const cv::Mat& first, const cv::Mat& second, const cv::Mat& window) {
  cv::Point2d shift = cv::phaseCorrelate(first, second, window);
  cv::Mat across, down;
  cv::Sobel(first, across, CV_32F, 1, 0, 3, 1.0 / 8.0);
  cv::Sobel(first, down, CV_32F, 0, 1, 3, 1.0 / 8.0);
  const cv::Mat weighted_across = across.mul(window);
  const cv::Mat weighted_down = down.mul(window);
  const double xx = weighted_across.dot(across), xy = weighted_across.dot(down), yy = weighted_down.dot(down);
  const double determinant = xx * yy - xy * xy;
  if (determinant <= kMinTexture * xx * yy || xx * yy <= 0.0) return shift;
  for (int i = 0; i < kRefinements; ++i) {
    const cv::Matx23d back(1.0, 0.0, shift.x, 0.0, 1.0, shift.y);
    cv::Mat moved;
    cv::warpAffine(second, moved, back, first.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                   cv::BORDER_REPLICATE);
    const cv::Mat difference = first - moved;
    const double bx = weighted_across.dot(difference), by = weighted_down.dot(difference);
    const cv::Point2d step((yy * bx - xy * by) / determinant, (xx * by - xy * bx) / determinant);
    if (cv::norm(step) > kMaxStep) break;
    shift += step;
  }
  return shift;
}

}  // namespace

void ImageMotionTracker::addImage(double time, const cv::Mat& image) {
  if (!motion_.times.empty() && time <= motion_.times.back()) return;
  cv::Mat small = cropAndReduce(image);
  cv::Point2d position(0.0, 0.0);
  if (small.size() == last_.size()) {
    position = motion_.positions.back() + estimateShift(last_, small, window_) / kWidth;
  } else {
    cv::createHanningWindow(window_, small.size(), CV_32F);
    if (!motion_.positions.empty()) position = motion_.positions.back();
  }
  last_ = small;
  motion_.times.push_back(time);
  motion_.positions.push_back(position);
}

ImageMotion measureImageMotion(capture::VideoFileSource& video, const std::function<void()>& progress) {
  ImageMotionTracker tracker;
  capture::Frame frame;
  while (video.read(frame, std::chrono::milliseconds(0)) == capture::ReadOutcome::frame) {
    tracker.addImage(video.fileTime(), frame.image);
    progress();
  }
  return tracker.motion();
}

}  // namespace cartvo
