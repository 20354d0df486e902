#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/evaluate/figures.hpp"

namespace cartvo {

/// Names of the files that a report was made from.
struct ReportFiles {
  std::string estimate, truth;
  std::string odometry;  ///< empty: no messages are known
};

/// One HTML page with all measures and figures, which needs no other file.
std::string evaluationPage(const ReportFiles& files, const ReportInput& input,
                           const std::vector<Figure>& figures);

/// Writes each figure as NAME.svg and NAME.png into a folder, which must exist.
void writeFigures(const std::filesystem::path& folder, const std::vector<Figure>& figures);

}  // namespace cartvo
