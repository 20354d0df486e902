// Real unsynchronised images: every second image of each of two synchronised cameras.
#include "tools/benchmark/offset/alternate_frames.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "capture/dataset/image_folder.hpp"
#include "tools/benchmark/chosen_images.hpp"
#include "tools/benchmark/simultaneous.hpp"

namespace cartvo::benchmark {
namespace {

/// Every second of the indices 0 to count - 1, from `first` on.
Indices everySecond(std::size_t count, std::size_t first) {
  Indices indices;
  for (std::size_t i = first; i < count; i += 2)
    indices.push_back(i);
  return indices;
}

}  // namespace

capture::StereoSource openAlternate(const std::filesystem::path& folder, RightFrames right,
                                    bool simultaneous) {
  const capture::ImageFolder images = capture::readImageFolder(folder);
  const capture::ImageSequence left = chosen(images.left, everySecond(images.left.images.size(), 0));
  const capture::ImageSequence other =
      chosen(images.right, everySecond(images.right.images.size(), right == RightFrames::next ? 1 : 0));
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
  return {chosen(truth.left_camera, everySecond(truth.left_camera.size(), 0)),
          chosen(truth.body_twist, everySecond(truth.body_twist.size(), 0))};
}

}  // namespace cartvo::benchmark
