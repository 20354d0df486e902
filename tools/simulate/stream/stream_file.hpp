#pragma once

#include <string>
#include <string_view>

#include "tools/simulate/stream/encoded_stream.hpp"

namespace cartvo::simulate {

// File format of cached streams: a line that names the format, the cache key, both streams, and digestOf()
// all that. Little-endian, like every machine that cartvo supports.

/// Serialises the streams with their cache key.
std::string streamFileContents(const EncodedPair& pair, std::string_view key);

/// Parses the contents of a file. Throws std::runtime_error with the reason if they are damaged, truncated,
/// of another format or for another key.
EncodedPair parseStreamFile(std::string_view contents, std::string_view key);

}  // namespace cartvo::simulate
