// Cells about VALID messages.
#include "tools/benchmark/validity_cells.hpp"

#include "tools/report/table.hpp"

namespace cartvo::benchmark {

std::vector<std::string> withValidityColumns(std::vector<std::string> header) {
  for (const char* name : {"> limit", "> bound", "available, %", "gap, s"})
    header.emplace_back(name);
  return header;
}

std::vector<std::string> withValidity(std::vector<std::string> row, const ValidityFigures& figures) {
  for (const std::size_t count : {figures.above_limit, figures.above_bound})
    row.push_back(std::to_string(count));
  row.push_back(fixed(100.0 * figures.availability(), 1));
  row.push_back(fixed(figures.longest_gap, 2));
  return row;
}

}  // namespace cartvo::benchmark
