#pragma once

#include <nlohmann/json.hpp>

#include "tools/calibrate/views/stream_views.hpp"

namespace cartvo {

/// The progress of the collection of views as JSON, for the page's script.
nlohmann::ordered_json liveState(const StreamProgress& progress);

/// A camera's picture with its corners as JPEG, at most 960 px wide. Empty without a picture.
std::string liveJpeg(const CameraPreview& preview);

}  // namespace cartvo
