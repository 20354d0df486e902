// Creates the output folder of a replay and writes its timing file.

#include "tools/replay/output_files.hpp"

#include <cerrno>
#include <cstdio>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <unistd.h>

#include "common/atomic_file.hpp"

namespace cartvo {

OutputFolder::OutputFolder(std::filesystem::path folder) : folder_(std::move(folder)) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (fs::exists(folder_, error) && !fs::is_directory(folder_)) {
    throw std::runtime_error(
        folder_.string() +
        ": is not a folder; --output-dir needs a folder, which is created if it is missing");
  }
  created_ = createFolders(folder_);
  if (::access(folder_.c_str(), W_OK | X_OK) != 0) {
    throw std::runtime_error(folder_.string() + ": is not writable: " +
                             std::generic_category().message(errno) + "; choose another --output-dir");
  }
}

OutputFolder::~OutputFolder() {
  std::error_code not_empty;
  for (auto folder = created_.rbegin(); folder != created_.rend() && !not_empty; ++folder)
    std::filesystem::remove(*folder, not_empty);
}

std::string timingCsv(const Replay& replay) {
  std::string csv = "pair";
  for (int stage = 0; stage < vo::kStageCount; ++stage)
    csv += std::string(",") + vo::stageName(static_cast<vo::Stage>(stage)) + "_ms";
  csv += ",total_ms\n";
  char text[32];
  for (std::size_t index = 0; index < replay.pairs.size(); ++index) {
    const pipeline::StageTimes& times = replay.pairs[index].times;
    csv += std::to_string(index);
    for (const double seconds : times.stages) {
      std::snprintf(text, sizeof text, ",%.4f", 1000.0 * seconds);
      csv += text;
    }
    std::snprintf(text, sizeof text, ",%.4f\n", 1000.0 * times.total);
    csv += text;
  }
  return csv;
}

}  // namespace cartvo
