#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "capture/isapi/http_connection.hpp"

namespace cartvo::capture {

/// File with the keys of cameras that were met over HTTPS, one line "HOST:PORT sha256//BASE64" each. Cameras
/// sign their certificates themselves, so that the key of the first meeting is kept and required from then
/// on.
class KnownCameras {
 public:
  /// Reads the file; a missing one is empty. Throws std::runtime_error naming file and line.
  explicit KnownCameras(std::filesystem::path file);

  std::optional<std::string> keyOf(const HttpAddress& address) const;

  /// Adds a camera and writes the file. Throws as writeFileAtomically does.
  void add(const HttpAddress& address, const std::string& key);

  const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path file_;
  std::string text_;
};

}  // namespace cartvo::capture
