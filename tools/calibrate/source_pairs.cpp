// Iteration over the synchronised pairs of a source on disk.
#include "tools/calibrate/source_pairs.hpp"

#include <chrono>

namespace cartvo::calibrate {

void forEachPair(capture::StereoSource& source, const std::function<bool(const capture::FramePair&)>& use) {
  capture::PairSynchroniserSettings settings;
  settings.period_ns = source.period_ns;
  capture::PairSynchroniser synchroniser(settings);
  // The pairs do not depend on the order in which the two cameras' frames are read.
  for (bool any = true; any;) {
    any = false;
    for (const capture::CameraSide side : {capture::CameraSide::left, capture::CameraSide::right}) {
      capture::CameraSource& camera = side == capture::CameraSide::left ? *source.left : *source.right;
      capture::Frame frame;
      if (camera.read(frame, std::chrono::milliseconds(0)) != capture::ReadOutcome::frame) continue;
      any = true;
      synchroniser.push(side, std::move(frame));
    }
    while (const std::optional<capture::FramePair> pair = synchroniser.pop()) {
      if (!use(*pair)) return;
    }
  }
}

}  // namespace cartvo::calibrate
