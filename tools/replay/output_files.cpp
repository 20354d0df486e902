#include "tools/replay/output_files.hpp"

#include <cstdio>
#include <stdexcept>

namespace cartvo {

void prepareOutputFolder(const std::filesystem::path& folder) {
  if (std::filesystem::exists(folder) && !std::filesystem::is_directory(folder)) {
    throw std::runtime_error(folder.string() +
                             ": is not a folder; --output-dir takes one, made if it is missing");
  }
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw std::runtime_error(folder.string() + ": cannot be made: " + error.message());
}

std::string timingCsv(const Replay& replay) {
  std::string csv = "pair";
  for (int stage = 0; stage < kStageCount; ++stage)
    csv += std::string(",") + stageName(static_cast<Stage>(stage)) + "_ms";
  csv += ",total_ms\n";
  char text[32];
  for (std::size_t index = 0; index < replay.pairs.size(); ++index) {
    const StageTimes& times = replay.pairs[index].times;
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
