// Keeps pairs of two cameras for the checks of pictures and odometry.
#include "tools/doctor/cameras/kept_pairs.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace cartvo::doctor {
namespace {

constexpr std::size_t kMaxPairs = 40, kMinPairs = 2, kMaxBytes = 150'000'000;
constexpr std::int64_t kSpread_ns = 250'000'000;

std::size_t capacity(const capture::FramePair& pair) {
  const std::size_t bytes = pair.left.image.total() + pair.right.image.total();
  return std::clamp(kMaxBytes / std::max<std::size_t>(1, bytes), kMinPairs, kMaxPairs);
}

void makeOwned(capture::Frame& frame) {
  frame.image = frame.image.clone();
  frame.storage.reset();
}

}  // namespace

void PairKeeper::add(capture::FramePair pair) {
  makeOwned(pair.left);
  makeOwned(pair.right);
  const std::size_t most = capacity(pair);
  const bool is_spread =
      spread_.empty() || pair.left.exposure_ns - spread_.back().left.exposure_ns >= kSpread_ns;
  if (is_spread && spread_.size() < most) spread_.push_back(pair);
  has_all_spread_ = spread_.size() >= most;
  consecutive_.push_back(std::move(pair));
  while (consecutive_.size() > most)
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
