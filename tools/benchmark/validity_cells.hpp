#pragma once

#include <string>
#include <vector>

#include "tools/benchmark/grouping.hpp"
#include "tools/evaluate/validity/validity_figures.hpp"

// The part about VALID messages that all benchmarks' tables have.

namespace cartvo::benchmark {

/// Appends columns: messages above an alert limit, those above their bound, available, longest gap.
std::vector<std::string> withValidityColumns(std::vector<std::string> header);
std::vector<std::string> withValidity(std::vector<std::string> row, const ValidityFigures& figures);

/// A line with the figures of all messages for each name that `name_of` gives to results with an `accuracy`.
template <typename Result, typename NameOf>
std::string validityTotals(const std::vector<Result>& results, const NameOf& name_of) {
  const auto same = [&](const Result& a, const Result& b) { return name_of(a) == name_of(b); };
  std::string lines;
  for (const std::vector<Result>& group : grouped(results, same)) {
    ValidityFigures all;
    for (const Result& one : group)
      all.add(one.accuracy.validity);
    lines += name_of(group.front()) + ": " + validityLine(all) + "\n";
  }
  return lines;
}

/// The legend of these columns.
inline constexpr const char* kValidityLegend =
    "> limit: VALID messages with an error above an alert limit: of a component of the velocity, of the\n"
    "angular rate or of the motion over the last second. > bound: VALID messages with an error above the\n"
    "bound that they state. available: share of VALID messages among all pairs; gap: longest time without\n"
    "one.\n";

}  // namespace cartvo::benchmark
