#pragma once

#include <vector>

#include "calib/model/rig.hpp"
#include "tools/doctor/finding_list.hpp"
#include "tools/doctor/picture_pair.hpp"

// Checks of what the pictures of both cameras show: light, sharpness, rows, static parts.

namespace cartvo::doctor {

/// Looks at some pairs of raw pictures, in order of time. `rig`: of these cameras; nullptr if there is none,
/// or none that can be read. Pairs whose pictures are not of the rig's size say nothing about it. Static
/// parts need 30 pairs of a drive, 0.25 s or more apart; rows need cameras that are synchronised, or stand.
void checkPictures(const std::vector<PicturePair>& pairs, const calib::Rig* rig, FindingList& findings);

}  // namespace cartvo::doctor
