// Real unsynchronised images: every second image of each of two synchronised cameras.
#include "tools/benchmark/offset/alternate_frames.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "capture/dataset/image_folder.hpp"
#include "tools/benchmark/simultaneous.hpp"

namespace cartvo::benchmark {
namespace {

template <typename Item>
std::vector<Item> everySecond(const std::vector<Item>& items, std::size_t first) {
  std::vector<Item> half;
  for (std::size_t i = first; i < items.size(); i += 2)
    half.push_back(items[i]);
  return half;
}

capture::ImageSequence everySecond(const capture::ImageSequence& sequence, std::size_t first) {
  return {everySecond(sequence.images, first), everySecond(sequence.instants_ns, first), sequence.stddev_ns,
          sequence.grey_range};
}

}  // namespace

capture::StereoSource openAlternate(const std::filesystem::path& folder, RightFrames right,
                                    bool simultaneous) {
  const capture::ImageFolder images = capture::readImageFolder(folder);
  const capture::ImageSequence left = everySecond(images.left, 0);
  const capture::ImageSequence other = everySecond(images.right, right == RightFrames::next ? 1 : 0);
  capture::StereoSource source = capture::openSource(folder);
  // Frames are paired within half of source.period_ns, and the next frame is exactly half of the doubled
  // period away: 10 % more for instants that are not evenly spaced.
  source.period_ns = capture::nominalPeriodNs(left) * 11 / 10;
  source.pairs = std::min(left.images.size(), other.images.size());
  if (simultaneous) {
    playSimultaneously(source, left, other);
  } else {
    source.left = std::make_unique<capture::ImageSequenceSource>(left);
    source.right = std::make_unique<capture::ImageSequenceSource>(other);
  }
  return source;
}

SequenceTruth alternate(const SequenceTruth& truth) {
  return {everySecond(truth.left_camera, 0), everySecond(truth.body_twist, 0)};
}

}  // namespace cartvo::benchmark
