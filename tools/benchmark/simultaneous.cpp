// Plays unsynchronised images with the left instant for both images of a pair.
#include "tools/benchmark/simultaneous.hpp"

#include <memory>

#include "capture/dataset/image_folder.hpp"

namespace cartvo::benchmark {
namespace {

/// `right` with the instants of the left images, paired as by PairSynchroniser: each image with the first
/// free one within half a period.
ImageSequence stampedAs(const ImageSequence& left, const ImageSequence& right, std::int64_t period_ns) {
  ImageSequence stamped;
  std::size_t partner = 0;
  for (std::size_t i = 0; i < right.images.size(); ++i) {
    while (partner < left.instants_ns.size() &&
           left.instants_ns[partner] < right.instants_ns[i] - period_ns / 2)
      ++partner;
    if (partner == left.instants_ns.size()) break;
    if (left.instants_ns[partner] > right.instants_ns[i] + period_ns / 2) continue;
    stamped.images.push_back(right.images[i]);
    stamped.instants_ns.push_back(left.instants_ns[partner++]);
  }
  stamped.stddev_ns = right.stddev_ns;
  return stamped;
}

}  // namespace

void playSimultaneously(StereoSource& source, const ImageSequence& left, const ImageSequence& right) {
  source.left = std::make_unique<ImageSequenceSource>(left);
  source.right = std::make_unique<ImageSequenceSource>(stampedAs(left, right, source.period_ns));
}

StereoSource openSimultaneous(const std::filesystem::path& folder) {
  const ImageFolder images = readImageFolder(folder);
  StereoSource source = openSource(folder);
  playSimultaneously(source, images.left, images.right);
  return source;
}

}  // namespace cartvo::benchmark
