#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "tools/simulate/stream/encoded_stream.hpp"

namespace cartvo::simulate {

/// Disk cache of encoded streams and of folders of rendered drives, by key. Files are written atomically;
/// damaged files are detected and removed.
class StreamCache {
 public:
  /// `max_bytes`: limit for all together; the least recently used files and folders are removed first.
  StreamCache(std::filesystem::path folder, std::uint64_t max_bytes);

  /// $XDG_CACHE_HOME/cartvo, else ~/.cache/cartvo, else (without a home) a folder in the temporary directory.
  static std::filesystem::path defaultFolder();

  /// The streams cached under `key`; none if there are none or their file is damaged.
  std::optional<EncodedPair> load(const std::string& key) const;

  /// Caches the streams unless they exceed the limit. Throws std::runtime_error that names the file if it
  /// cannot be written.
  void store(const std::string& key, const EncodedPair& pair) const;

  /// Why nothing can be cached; empty if it can. For use before the work.
  std::string problem() const;

  /// Path of the file for `key`, which need not exist.
  std::filesystem::path fileFor(const std::string& key) const;

  /// The folder of the rendered drive `key`. If it is not there, `render` makes a folder of the given path,
  /// which then takes the name.
  std::filesystem::path driveFolder(const std::string& key,
                                    const std::function<void(const std::filesystem::path&)>& render) const;

 private:
  void makeRoomFor(std::uint64_t bytes) const;

  std::filesystem::path folder_;
  std::uint64_t max_bytes_;
};

}  // namespace cartvo::simulate
