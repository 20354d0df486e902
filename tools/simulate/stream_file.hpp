#pragma once

#include <string>
#include <string_view>

#include "tools/simulate/encoded_stream.hpp"

namespace cartvo::simulate {

// Encoded streams as one file: a line that names the format, the key they were made for, both streams, and an
// XXH3 checksum of all that. Little-endian, as every machine that cartvo runs on.

std::string streamFileContents(const EncodedPair& pair, std::string_view key);

/// The reverse. Throws std::runtime_error saying what is wrong if the contents are damaged, cut short, of
/// another format or made for another key.
EncodedPair parseStreamFile(std::string_view contents, std::string_view key);

}  // namespace cartvo::simulate
