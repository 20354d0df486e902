// Real images that are not synchronised: half of what each of two synchronised cameras took.
#include "tools/benchmark/alternate_frames.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "capture/image_folder.hpp"
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

ImageSequence everySecond(const ImageSequence& sequence, std::size_t first) {
  return {everySecond(sequence.images, first), everySecond(sequence.instants_ns, first)};
}

}  // namespace

StereoSource openAlternate(const std::filesystem::path& folder, RightFrames right, bool simultaneous) {
  const ImageFolder images = readImageFolder(folder);
  const ImageSequence left = everySecond(images.left, 0);
  const ImageSequence other = everySecond(images.right, right == RightFrames::next ? 1 : 0);
  StereoSource source = openSource(folder);
  // Half a period is just what the next frames are apart: a tenth more, for instants that are not quite even.
  source.period_ns = nominalPeriodNs(left) * 11 / 10;
  source.pairs = std::min(left.images.size(), other.images.size());
  if (simultaneous) {
    playSimultaneously(source, left, other);
  } else {
    source.left = std::make_unique<ImageSequenceSource>(left);
    source.right = std::make_unique<ImageSequenceSource>(other);
  }
  return source;
}

SequenceTruth alternate(const SequenceTruth& truth) {
  return {everySecond(truth.left_camera, 0), everySecond(truth.body_twist, 0)};
}

}  // namespace cartvo::benchmark
