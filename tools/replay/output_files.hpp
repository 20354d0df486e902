#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/replay/replay.hpp"

namespace cartvo {

/// Output folder, created if it is missing. The destructor removes the folders that were created and are
/// still empty, because the replay failed before a file was written.
class OutputFolder {
 public:
  /// Throws std::runtime_error if the path is not a folder, or is not writable.
  explicit OutputFolder(std::filesystem::path folder);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }

 private:
  std::filesystem::path folder_;
  std::vector<std::filesystem::path> created_;  ///< outermost first
};

/// Text of `timing.csv`, one row per pair: `pair`, processing time of each stage in ms (`rectify_ms`, ...),
/// `total_ms`. Reading and decoding of images are not included.
std::string timingCsv(const Replay& replay);

}  // namespace cartvo
