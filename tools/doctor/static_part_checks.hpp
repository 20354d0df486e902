#pragma once

#include <atomic>

#include "calib/model/rig.hpp"
#include "capture/stereo_source.hpp"
#include "tools/doctor/finding_list.hpp"

namespace cartvo::doctor {

/// Looks for parts of the pictures of a drive that keep their place, in a source on disk that was just
/// opened: of a camera that `rig` (may be nullptr) gives no mask. Reads until there are enough pictures, some
/// 15 s of driving. Ends early once `interrupted` is true.
void checkStaticParts(capture::StereoSource& source, const calib::Rig* rig,
                      const std::atomic<bool>& interrupted, FindingList& findings);

}  // namespace cartvo::doctor
