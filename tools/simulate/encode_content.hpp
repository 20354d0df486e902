#pragma once

#include <functional>

#include "tools/simulate/content.hpp"
#include "tools/simulate/encoded_stream.hpp"
#include "tools/simulate/stream_encoder.hpp"

namespace cartvo::simulate {

/// Told after each pair: how many are done, of how many. May throw to give up.
using Progress = std::function<void(int done, int total)>;

/// Encodes both cameras' pictures, each behind a lead-in: of its first one standing still, or blank where the
/// content does not begin standing. Throws
/// std::invalid_argument if the content has no pair or pictures of another size than its rig says.
EncodedPair encodeContent(const Content& content, const EncoderSettings& settings, const Progress& progress);

}  // namespace cartvo::simulate
