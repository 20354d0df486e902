#pragma once

#include <string>
#include <vector>

#include "tools/evaluate/figures.hpp"

namespace cartvo {

/// Several estimates side by side: a row for each.
struct ComparisonTable {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;

  /// Aligned text, and below it the problems with the name of their estimate.
  std::string text;
};

ComparisonTable comparisonTable(const std::vector<ReportInput>& inputs);

}  // namespace cartvo
