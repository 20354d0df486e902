#pragma once

#include <string_view>

namespace cartvo::capture {

/// Whether an encoded PNG, JPEG or BMP ends before its last part; false for other data. Decoders make grey of
/// the missing rows of a JPEG without an error. Extraneous bytes between the parts of a JPEG are no damage:
/// many USB cameras send them.
bool isCutOffImage(std::string_view bytes);

}  // namespace cartvo::capture
