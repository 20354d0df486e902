// Keeps the last pairs of two cameras.
#include "tools/doctor/cameras/kept_pairs.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

namespace cartvo::doctor {
namespace {

constexpr std::size_t kMaxPairs = 40, kMinPairs = 2, kMaxBytes = 200'000'000;

}  // namespace

std::size_t keptPairCapacity(const capture::FramePair& pair) {
  const std::size_t bytes = pair.left.image.total() + pair.right.image.total();
  return std::clamp(kMaxBytes / std::max<std::size_t>(1, bytes), kMinPairs, kMaxPairs);
}

capture::FramePair ownedPair(capture::FramePair pair) {
  for (capture::Frame* frame : {&pair.left, &pair.right}) {
    frame->image = frame->image.clone();
    frame->storage.reset();
  }
  return pair;
}

KeptPairs::KeptPairs(std::int64_t period_ns) : synchroniser_({.period_ns = period_ns}) {}

void KeptPairs::add(capture::CameraSide side, const capture::Frame& frame) {
  const std::lock_guard lock(mutex_);
  synchroniser_.push(side, frame);
  while (std::optional<capture::FramePair> pair = synchroniser_.pop()) {
    pairs_.push_back(ownedPair(std::move(*pair)));
    while (pairs_.size() > keptPairCapacity(pairs_.back()))
      pairs_.pop_front();
  }
}

std::vector<capture::FramePair> KeptPairs::take() {
  const std::lock_guard lock(mutex_);
  return {std::make_move_iterator(pairs_.begin()), std::make_move_iterator(pairs_.end())};
}

}  // namespace cartvo::doctor
