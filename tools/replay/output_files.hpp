#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/replay/replay.hpp"

namespace cartvo {

/// The folder that results are written into, made if it is missing; what was made for nothing, because the
/// work failed before a file was written, is removed again.
class OutputFolder {
 public:
  /// Throws std::runtime_error if the path is something else, or nothing can be written there.
  explicit OutputFolder(std::filesystem::path folder);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }

 private:
  std::filesystem::path folder_;
  std::vector<std::filesystem::path> made_;  ///< outermost first
};

/// `timing.csv`: a row per pair: `pair`, the milliseconds of each stage (`rectify_ms`, ...), `total_ms`.
/// Reading and decoding of images are not part of it.
std::string timingCsv(const Replay& replay);

}  // namespace cartvo
