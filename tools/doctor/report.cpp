// Texts and JSON of findings.
#include "tools/doctor/report.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace cartvo::doctor {
namespace {

std::string detailLine(const char* name, const std::string& text) {
  constexpr const char* kIndent = "               ";
  return text.empty() ? "" : fmt::format("{}{:<10}{}\n", kIndent, name, text);
}

std::string findingText(const Finding& finding) {
  std::string text =
      fmt::format("  {:<13}{}: {}\n", namesOf(finding.verdict).text, finding.subject, finding.seen);
  if (finding.verdict == Verdict::ok) return text;
  return text + detailLine("expected", finding.expected) + detailLine("do", finding.advice);
}

std::ptrdiff_t count(const Findings& findings, Verdict verdict) {
  return std::count_if(findings.begin(), findings.end(),
                       [verdict](const Finding& finding) { return finding.verdict == verdict; });
}

}  // namespace

const VerdictNames& namesOf(Verdict verdict) {
  static constexpr std::array<VerdictNames, 4> kNames{{{"not checked", "not_checked", "unchecked"},
                                                       {"ok", "ok", "ok"},
                                                       {"look at", "look_at", "look"},
                                                       {"broken", "broken", "broken"}}};
  return kNames.at(static_cast<std::size_t>(verdict));
}

Verdict worstVerdict(const Findings& findings) {
  Verdict worst = Verdict::ok;
  for (const Finding& finding : findings)
    worst = std::max(worst, finding.verdict);
  return worst;
}

std::string areaText(const Findings& findings) {
  if (findings.empty()) return {};
  std::string text = findings.front().area + "\n";
  for (const Finding& finding : findings)
    text += findingText(finding);
  return text;
}

std::string countsText(const Findings& findings) {
  return fmt::format("{} broken, {} to look at, {} ok, {} not checked", count(findings, Verdict::broken),
                     count(findings, Verdict::look_at), count(findings, Verdict::ok),
                     count(findings, Verdict::not_checked));
}

Findings bySeverity(const Findings& findings) {
  Findings severe;
  for (const Verdict verdict : {Verdict::broken, Verdict::look_at})
    std::copy_if(findings.begin(), findings.end(), std::back_inserter(severe),
                 [verdict](const Finding& finding) { return finding.verdict == verdict; });
  return severe;
}

std::string namesText(const Findings& findings) {
  std::string text;
  const Finding* last = nullptr;
  const Findings severe = bySeverity(findings);
  for (const Finding& finding : severe) {
    const bool starts = last == nullptr || last->verdict != finding.verdict;
    if (starts) text += (text.empty() ? "" : "\n") + std::string(namesOf(finding.verdict).text) + ": ";
    text += (starts ? "" : "; ") + finding.area + ", " + finding.subject;
    last = &finding;
  }
  return text.empty() ? text : text + "\n";
}

nlohmann::ordered_json findingsJson(const ReportHead& head, const Findings& findings) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Finding& finding : findings) {
    list.push_back({{"area", finding.area},
                    {"subject", finding.subject},
                    {"verdict", namesOf(finding.verdict).key},
                    {"seen", finding.seen},
                    {"expected", finding.expected},
                    {"advice", finding.advice}});
  }
  return {{"version", head.version},
          {"time", head.time},
          {"host", head.host},
          {"source", head.source},
          {"verdict", namesOf(worstVerdict(findings)).key},
          {"counts",
           {{"broken", count(findings, Verdict::broken)},
            {"look_at", count(findings, Verdict::look_at)},
            {"ok", count(findings, Verdict::ok)},
            {"not_checked", count(findings, Verdict::not_checked)}}},
          {"findings", std::move(list)}};
}

}  // namespace cartvo::doctor
