#pragma once

#include <nlohmann/json.hpp>

#include "tools/calibrate/stream_views.hpp"

namespace cartvo {

/// How the taking of views stands, as the page's script reads it.
nlohmann::ordered_json liveState(const StreamProgress& progress);

/// A picture with the corners found in it, at most 960 px wide, as JPEG.
std::string liveJpeg(const StreamSight& sight);

}  // namespace cartvo
