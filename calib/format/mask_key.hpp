#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <opencv2/core/types.hpp>

#include "calib/model/rig.hpp"

namespace cartvo {
class StrictYaml;
}  // namespace cartvo

// The key `mask` of a camera in cartvo's rig files. It is the name of a PNG file, an embedded PNG
// ("data:image/png;base64,..."), or a list of polygons [[[x, y], [x, y], [x, y]], ...]. Pixels of an image
// that are darker than middle grey are not used.

namespace cartvo::calib {

/// Largest share of an image that a mask may take: what masks more is mostly black and white exchanged, and
/// no motion can be measured with the rest.
constexpr double kMaxMaskedShare = 0.75;

/// Reads the mask of raw images of this size. `folder`: where names of files start; none for a text that is
/// not a file, such as that in a recording, which cannot name files. Throws std::runtime_error that names
/// file, line, key, what was expected and what to do, also for an image of another size and a mask above
/// kMaxMaskedShare.
StaticMask readMask(const StrictYaml& yaml, cv::Size size,
                    const std::optional<std::filesystem::path>& folder);

/// The value of the key. With a `folder`, in which the rig file is, an image file is named; without one it is
/// embedded. The mask must not be empty.
std::string maskText(const StaticMask& mask, const std::optional<std::filesystem::path>& folder);

/// The mask as a PNG file: black where the image must not be used, white elsewhere.
std::string maskPng(const StaticMask& mask);

}  // namespace cartvo::calib
