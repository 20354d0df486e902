#pragma once

#include <string>

#include "calib/model/rig.hpp"
#include "tools/doctor/picture_pair.hpp"

namespace cartvo::doctor {

/// HTML figures of a pair for the report: the left picture, the right picture and, with a `rig` (may be
/// nullptr) of their size, both rectified, each at half strength, with lines along rows. The pictures are
/// embedded as JPEG of at most 960 px width and have texts for those who cannot see them.
std::string pictureFigures(const PicturePair& pair, const calib::Rig* rig);

}  // namespace cartvo::doctor
