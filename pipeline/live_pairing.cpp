// Passes pairs from the cameras' threads to the odometry's thread; keeps only the newest.

#include "pipeline/live_pairing.hpp"

#include <utility>

#include "common/image_size.hpp"

namespace cartvo::pipeline {

PairingTotals totals(const capture::PairSynchroniser& synchroniser) {
  const capture::PairingCounts& left = synchroniser.counts(capture::CameraSide::left);
  const capture::PairingCounts& right = synchroniser.counts(capture::CameraSide::right);
  PairingTotals sum;
  sum.pairs = left.paired;
  sum.frames.received = left.received + right.received;
  sum.frames.paired = left.paired + right.paired;
  sum.frames.no_partner = left.no_partner + right.no_partner;
  sum.frames.damaged = left.damaged + right.damaged;
  sum.frames.out_of_order = left.out_of_order + right.out_of_order;
  sum.frames.overflow = left.overflow + right.overflow;
  sum.frames.clock_restarted = left.clock_restarted + right.clock_restarted;
  return sum;
}

std::string wrongSizeMessage(capture::CameraSide side, cv::Size stream, cv::Size rig) {
  return std::string(side == capture::CameraSide::left ? "left" : "right") + " camera: the stream is " +
         sizeText(stream) + ", but the rig is for " + sizeText(rig) +
         "; set the camera to the rig's resolution, or calibrate at the stream's (a camera may crop instead "
         "of scale)";
}

LivePairing::LivePairing(const capture::PairSynchroniserSettings& settings, cv::Size image_size)
    : synchroniser_(settings), image_size_(image_size) {}

void LivePairing::push(capture::CameraSide side, capture::Frame frame) {
  const std::lock_guard lock(mutex_);
  std::optional<cv::Size>& refused = refused_[static_cast<std::size_t>(side)];
  if (frame.image.size() != image_size_) {
    refused = frame.image.size();
    ++refused_size_;
    return;
  }
  refused.reset();
  synchroniser_.push(side, std::move(frame));
  while (std::optional<capture::FramePair> pair = synchroniser_.pop()) {
    if (newest_) ++skipped_;
    newest_ = std::move(pair);
  }
  if (newest_) changed_.notify_one();
}

void LivePairing::finish(capture::CameraSide side) {
  const std::lock_guard lock(mutex_);
  synchroniser_.finish(side);
  finished_[static_cast<std::size_t>(side)] = true;
  changed_.notify_one();
}

std::optional<capture::FramePair> LivePairing::waitForPair(std::chrono::steady_clock::time_point deadline) {
  std::unique_lock lock(mutex_);
  changed_.wait_until(lock, deadline, [this] { return newest_.has_value() || bothFinished(); });
  return std::exchange(newest_, std::nullopt);
}

bool LivePairing::finished() const {
  const std::lock_guard lock(mutex_);
  return bothFinished() && !newest_;
}

LivePairing::Counts LivePairing::counts() const {
  const std::lock_guard lock(mutex_);
  return {totals(synchroniser_), skipped_, refused_size_};
}

std::array<std::int64_t, 2> LivePairing::periodsNs() const {
  const std::lock_guard lock(mutex_);
  return {synchroniser_.framePeriodNs(capture::CameraSide::left),
          synchroniser_.framePeriodNs(capture::CameraSide::right)};
}

std::string LivePairing::problem() const {
  const std::lock_guard lock(mutex_);
  for (const capture::CameraSide side : {capture::CameraSide::left, capture::CameraSide::right}) {
    const std::optional<cv::Size>& refused = refused_[static_cast<std::size_t>(side)];
    if (refused) return wrongSizeMessage(side, *refused, image_size_);
  }
  return {};
}

}  // namespace cartvo::pipeline
