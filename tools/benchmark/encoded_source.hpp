#pragma once

#include <memory>

#include "capture/stereo_source.hpp"
#include "tools/simulate/stream/encoded_stream.hpp"

namespace cartvo::benchmark {

/// Plays two H.264 streams from memory through VideoDecoder, as fast as they are read and without the lead-in
/// of the simulated cameras. Instants are those of the content.
capture::StereoSource openEncoded(const std::shared_ptr<const simulate::EncodedPair>& streams);

}  // namespace cartvo::benchmark
