// From the odometry's thread to the page's, without locks.
#include "daemon/page/live_handover.hpp"

#include <utility>

namespace cartvo::daemon {
namespace {

constexpr std::chrono::milliseconds kViewPeriod{100};
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

}  // namespace cartvo::daemon
