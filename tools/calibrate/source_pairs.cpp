// Iteration over the synchronised pairs of a source on disk.
#include "tools/calibrate/source_pairs.hpp"

#include <chrono>

namespace cartvo::calibrate {

void forEachPair(StereoSource& source, const std::function<bool(const FramePair&)>& use) {
  PairSynchroniserSettings settings;
  settings.period_ns = source.period_ns;
  PairSynchroniser synchroniser(settings);
  // The pairs do not depend on the order in which the two cameras' frames are read.
  for (bool any = true; any;) {
    any = false;
    for (const CameraSide side : {CameraSide::left, CameraSide::right}) {
      CameraSource& camera = side == CameraSide::left ? *source.left : *source.right;
      Frame frame;
      if (camera.read(frame, std::chrono::milliseconds(0)) != ReadOutcome::frame) continue;
      any = true;
      synchroniser.push(side, std::move(frame));
    }
    while (const std::optional<FramePair> pair = synchroniser.pop()) {
      if (!use(*pair)) return;
    }
  }
}

}  // namespace cartvo::calibrate
