// Keeps pairs of two cameras for the checks of pictures and odometry.
#include "tools/doctor/cameras/kept_pairs.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace cartvo::doctor {
namespace {

struct Capacity {
  std::size_t pairs, bytes;
};
constexpr Capacity kConsecutive{40, 150'000'000}, kSpread{80, 300'000'000};
constexpr std::size_t kMinPairs = 2;

/// Number of pairs like this one.
std::size_t most(const Capacity& capacity, const capture::FramePair& pair) {
  const std::size_t bytes = pair.left.image.total() + pair.right.image.total();
  return std::clamp(capacity.bytes / std::max<std::size_t>(1, bytes), kMinPairs, capacity.pairs);
}

void makeOwned(capture::Frame& frame) {
  frame.image = frame.image.clone();
  frame.storage.reset();
}

void keepEverySecond(std::vector<capture::FramePair>& pairs) {
  std::vector<capture::FramePair> kept;
  for (std::size_t i = 0; i < pairs.size(); i += 2)
    kept.push_back(std::move(pairs[i]));
  pairs = std::move(kept);
}

}  // namespace

void PairKeeper::add(capture::FramePair pair) {
  makeOwned(pair.left);
  makeOwned(pair.right);
  if (spread_.empty() || pair.left.exposure_ns - spread_.back().left.exposure_ns >= distance_ns_)
    spread_.push_back(pair);
  if (spread_.size() > most(kSpread, pair)) {
    keepEverySecond(spread_);
    distance_ns_ *= 2;
  }
  consecutive_.push_back(std::move(pair));
  while (consecutive_.size() > most(kConsecutive, consecutive_.back()))
    consecutive_.pop_front();
}

KeptPairs PairKeeper::take() {
  return {{std::make_move_iterator(consecutive_.begin()), std::make_move_iterator(consecutive_.end())},
          std::move(spread_)};
}

void LivePairKeeper::add(capture::CameraSide side, const capture::Frame& frame) {
  const std::lock_guard lock(mutex_);
  synchroniser_.push(side, frame);
  while (std::optional<capture::FramePair> pair = synchroniser_.pop())
    keeper_.add(std::move(*pair));
}

KeptPairs LivePairKeeper::take() {
  const std::lock_guard lock(mutex_);
  return keeper_.take();
}

}  // namespace cartvo::doctor
