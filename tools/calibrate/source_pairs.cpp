// Iteration over the synchronised pairs of a source on disk.
#include "tools/calibrate/source_pairs.hpp"

#include "capture/pair_synchroniser.hpp"

namespace cartvo::calibrate {

void forEachPair(capture::StereoSource& source, const std::function<bool(const capture::FramePair&)>& use) {
  capture::PairSynchroniserSettings settings;
  settings.period_ns = source.period_ns;
  capture::PairReader reader(*source.left, *source.right, settings);
  while (const std::optional<capture::FramePair> pair = reader.next()) {
    if (!use(*pair)) return;
  }
}

}  // namespace cartvo::calibrate
