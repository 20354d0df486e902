// Determines which picture a simulated camera sends next, and when.
#include "tools/simulate/server/frame_schedule.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace cartvo::simulate {
namespace {

/// Duration of `count` frame periods, ns.
std::int64_t framesToNs(std::int64_t count, double frame_rate) {
  return std::llround(static_cast<double>(count) * 1e9 / frame_rate);
}

}  // namespace

std::int64_t nextFrameInstant(std::int64_t switched_on_ns, double frame_rate, std::int64_t not_before_ns) {
  const double frames = static_cast<double>(not_before_ns - switched_on_ns) * 1e-9 * frame_rate;
  return switched_on_ns + framesToNs(std::llround(std::ceil(frames)), frame_rate);
}

FrameSchedule::FrameSchedule(std::shared_ptr<const EncodedStream> stream, std::int64_t switched_on_ns,
                             std::int64_t repeat_after_ns)
    : stream_(std::move(stream)), switched_on_ns_(switched_on_ns), repeat_after_ns_(repeat_after_ns) {
  if (!stream_ || stream_->units.empty() || stream_->lead_in.empty()) {
    throw std::invalid_argument("a simulated camera needs a stream with at least one picture");
  }
}

void FrameSchedule::startContent(std::int64_t epoch_ns) {
  if (!epoch_ns_) epoch_ns_ = epoch_ns;
}

std::int64_t FrameSchedule::leadInInstant() const {
  return switched_on_ns_ + stream_->units.front().instant_ns +
         framesToNs(lead_in_count_, stream_->frame_rate);
}

bool FrameSchedule::inLeadIn() const {
  if (content_count_ > 0) return false;
  if (!epoch_ns_) return true;
  // Skips a lead-in picture less than half a period before the content.
  return leadInInstant() + framesToNs(1, stream_->frame_rate) / 2 <=
         *epoch_ns_ + stream_->units.front().instant_ns;
}

std::optional<ScheduledUnit> FrameSchedule::next() const {
  if (inLeadIn()) {
    const auto index = static_cast<std::size_t>(lead_in_count_) % stream_->lead_in.size();
    return ScheduledUnit{.unit = &stream_->lead_in[index], .instant_ns = leadInInstant()};
  }
  const std::size_t repetition = content_count_ / stream_->units.size();
  if (repetition > 0 && repeat_after_ns_ == 0) return std::nullopt;
  const AccessUnit& unit = stream_->units[content_count_ % stream_->units.size()];
  return ScheduledUnit{
      .unit = &unit,
      .instant_ns = *epoch_ns_ + static_cast<std::int64_t>(repetition) * repeat_after_ns_ + unit.instant_ns};
}

void FrameSchedule::advance() {
  if (inLeadIn()) {
    ++lead_in_count_;
  } else {
    ++content_count_;
  }
}

}  // namespace cartvo::simulate
