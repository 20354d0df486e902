// From the odometry's thread to the page's, without locks.
#include "daemon/page/live_handover.hpp"

#include <limits>
#include <utility>

namespace cartvo::daemon {
namespace {

constexpr std::chrono::milliseconds kViewPeriod{100}, kPicturePeriod{200};
constexpr std::chrono::nanoseconds kViewerSilence = std::chrono::seconds(2);

}  // namespace

bool LiveHandover::hasViewer(Clock::time_point now) const {
  const std::int64_t last = last_viewer_ns_;
  return last != 0 && now.time_since_epoch().count() - last < kViewerSilence.count();
}

pipeline::PairView* LiveHandover::nextViewAt(Clock::time_point now) {
  is_filled_ = false;
  if (!hasViewer(now)) return nullptr;
  if (now < next_view_) return nullptr;
  next_view_ += kViewPeriod;  // ten a second on average, whatever the frame rate
  if (next_view_ <= now) next_view_ = now + kViewPeriod;
  if (!filling_) filling_ = used_.take();
  if (!filling_) filling_ = std::make_unique<PageSnapshot>();
  is_filled_ = true;
  return &filling_->view;
}

void LiveHandover::addPair(const PageSample& sample) {
  samples_.push(sample);
  if (!std::exchange(is_filled_, false)) return;
  filling_->sequence = sample.sequence();
  filling_ = snapshots_.put(std::move(filling_));
}

void LiveHandover::addFrame(capture::CameraSide side, const cv::Mat& picture, Clock::time_point now) {
  Camera& camera = cameras_[static_cast<std::size_t>(side)];
  camera.last_ns = now.time_since_epoch().count();
  if (!hasViewer(now) || now < camera.next_picture) return;
  camera.next_picture = now + kPicturePeriod;
  camera.picture.put(std::make_unique<cv::Mat>(picture.clone()));
}

CameraView LiveHandover::takeCamera(capture::CameraSide side, Clock::time_point now) {
  Camera& camera = cameras_[static_cast<std::size_t>(side)];
  const std::int64_t last = camera.last_ns;
  const std::unique_ptr<cv::Mat> picture = camera.picture.take();
  return {picture ? *picture : cv::Mat(),
          last == 0 ? std::numeric_limits<double>::quiet_NaN()
                    : std::chrono::duration<double>(now.time_since_epoch() - Clock::duration(last)).count()};
}

}  // namespace cartvo::daemon
