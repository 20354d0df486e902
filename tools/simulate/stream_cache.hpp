#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "tools/simulate/encoded_stream.hpp"

namespace cartvo::simulate {

/// Encoded streams kept on disk, each under the key of what it was made from. Files are written whole or not
/// at all; one that is damaged is noticed and removed.
class StreamCache {
 public:
  /// `most_bytes`: what all files may take together; those not used for longest go first.
  StreamCache(std::filesystem::path folder, std::uint64_t most_bytes);

  /// $XDG_CACHE_HOME/cartvo, or ~/.cache/cartvo, or (without a home) a folder among the temporary files.
  static std::filesystem::path defaultFolder();

  /// The streams kept under `key`, if there are sound ones.
  std::optional<EncodedPair> load(const std::string& key) const;

  /// Throws std::runtime_error naming the file if it cannot be written.
  void store(const std::string& key, const EncodedPair& pair) const;

  std::filesystem::path fileFor(const std::string& key) const;

 private:
  void makeRoomFor(std::uint64_t bytes) const;

  std::filesystem::path folder_;
  std::uint64_t most_bytes_;
};

}  // namespace cartvo::simulate
