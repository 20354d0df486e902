// Reads the pairs of two sources that end.
#include "capture/pair_reader.hpp"

#include <chrono>
#include <utility>

namespace cartvo::capture {
namespace {

/// Time that a source waits for a frame before it is asked again.
constexpr std::chrono::milliseconds kReadTimeout{200};

/// Order of two frames: of recording, which does not depend on clocks; where it is unknown, of exposure.
bool comesFirst(const Frame& left, const Frame& right) {
  if (left.order > 0 && right.order > 0) return left.order < right.order;
  return left.exposure_ns <= right.exposure_ns;
}

}  // namespace

void PairReader::LookAhead::fill() {
  while (!frame && !ended) {
    Frame next;
    const ReadOutcome outcome = source.read(next, kReadTimeout);
    if (outcome == ReadOutcome::frame) frame = std::move(next);
    ended = outcome == ReadOutcome::ended;
  }
}

PairReader::PairReader(CameraSource& left, CameraSource& right, const PairSynchroniserSettings& settings)
    : left_{left}, right_{right}, synchroniser_(settings) {}

std::optional<FramePair> PairReader::next() {
  for (;;) {
    if (std::optional<FramePair> pair = synchroniser_.pop()) return pair;
    left_.fill();
    right_.fill();
    if (!left_.frame && !right_.frame) return std::nullopt;
    const bool left_is_next = !right_.frame || (left_.frame && comesFirst(*left_.frame, *right_.frame));
    LookAhead& side = left_is_next ? left_ : right_;
    synchroniser_.push(left_is_next ? CameraSide::left : CameraSide::right,
                       *std::exchange(side.frame, std::nullopt));
  }
}

}  // namespace cartvo::capture
