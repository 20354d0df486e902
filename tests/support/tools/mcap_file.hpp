#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace cartvo::test {

/// A message of an MCAP file.
struct McapMessage {
  std::string topic, schema, encoding;
  std::uint64_t log_time = 0, publish_time = 0;
  std::string data;
};

/// Content of an MCAP file.
struct McapFile {
  std::string profile;
  std::vector<McapMessage> messages;           ///< in the order of the file
  std::map<std::string, std::string> schemas;  ///< encoding and data, joined by ':', by name
  std::size_t chunks = 0;
};

/// Reads a file strictly: each length, checksum, offset, index and count must be right, and the summary must
/// repeat what the data contain. Throws std::runtime_error with what is wrong.
McapFile readMcapFile(const std::string& bytes);

}  // namespace cartvo::test
