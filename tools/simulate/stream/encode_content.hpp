#pragma once

#include <functional>

#include "tools/simulate/content.hpp"
#include "tools/simulate/stream/encoded_stream.hpp"
#include "tools/simulate/stream/stream_encoder.hpp"

namespace cartvo::simulate {

/// Called after each pair with the number done and the total. May throw to cancel.
using Progress = std::function<void(int done, int total)>;

/// Encodes one key-frame interval of a grey picture as the stream's lead-in, so that it can be repeated.
/// `stream` has its size and rate.
void addBlankLeadIn(EncodedStream& stream, const EncoderSettings& settings);

/// Encodes the pictures of both cameras, each after a lead-in: the first picture, or a blank one if the
/// content does not start at standstill. Throws std::invalid_argument if the content has no pair or if the
/// size of its pictures differs from the rig's.
EncodedPair encodeContent(const Content& content, const EncoderSettings& settings, const Progress& progress);

}  // namespace cartvo::simulate
