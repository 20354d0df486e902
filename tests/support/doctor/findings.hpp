#pragma once

#include <algorithm>
#include <string>

#include <gmock/gmock.h>

#include "tools/doctor/report.hpp"

// Looking up findings in tests.

namespace cartvo::test {

/// The finding of a subject, else one with the subject "missing".
inline doctor::Finding findingOf(const doctor::Findings& findings, const std::string& subject) {
  const auto found = std::find_if(findings.begin(), findings.end(),
                                  [&](const doctor::Finding& finding) { return finding.subject == subject; });
  if (found != findings.end()) return *found;
  doctor::Finding missing;
  missing.subject = "missing: " + subject;
  return missing;
}

/// Matches a finding by its verdict and a part of what was seen.
MATCHER_P2(Saw, verdict, part, std::string(doctor::namesOf(verdict).text) + ": ..." + part + "...") {
  *result_listener << arg.subject << " is " << doctor::namesOf(arg.verdict).text << ": " << arg.seen;
  const bool is_complete = arg.verdict != doctor::Verdict::broken || !arg.advice.empty();
  return arg.verdict == verdict && is_complete && arg.seen.find(part) != std::string::npos;
}

}  // namespace cartvo::test

namespace cartvo::doctor {
inline void PrintTo(const Finding& finding, std::ostream* stream) {
  *stream << finding.subject << ": " << namesOf(finding.verdict).text << ": " << finding.seen;
}
}  // namespace cartvo::doctor
