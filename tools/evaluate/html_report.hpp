#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/evaluate/figures.hpp"

namespace cartvo {

/// Origin of a report apart from the estimates.
struct ReportContext {
  std::string truth;                  ///< name of its file
  std::string date;                   ///< of the report
  std::vector<std::string> settings;  ///< such as "rig KITTI"
};

/// One HTML page with all measures and figures, which needs no other file. `inputs` must not be empty.
std::string evaluationPage(const ReportContext& context, const std::vector<ReportInput>& inputs,
                           const std::vector<Figure>& figures);

/// Writes each figure as NAME.svg and NAME.png into a folder, which must exist.
void writeFigures(const std::filesystem::path& folder, const std::vector<Figure>& figures);

}  // namespace cartvo
