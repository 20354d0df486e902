// Plays unsynchronised images with the left instant for both images of a pair.
#include "tools/benchmark/simultaneous.hpp"

#include <memory>

#include "capture/dataset/image_folder.hpp"

namespace cartvo::benchmark {
namespace {

/// `right` with the instants of the left images, paired as by PairSynchroniser: each image with the first
/// free one within half a period.
capture::ImageSequence stampedAs(const capture::ImageSequence& left, const capture::ImageSequence& right,
                                 std::int64_t period_ns) {
  capture::ImageSequence stamped;
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

void playSimultaneously(capture::StereoSource& source, const capture::ImageSequence& left,
                        const capture::ImageSequence& right) {
  source.left = std::make_unique<capture::ImageSequenceSource>(left);
  source.right = std::make_unique<capture::ImageSequenceSource>(stampedAs(left, right, source.period_ns));
}

capture::StereoSource openSimultaneous(const std::filesystem::path& folder) {
  const capture::ImageFolder images = capture::readImageFolder(folder);
  capture::StereoSource source = capture::openSource(folder);
  playSimultaneously(source, images.left, images.right);
  return source;
}

}  // namespace cartvo::benchmark
