#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "common/printable_text.hpp"
#include "tools/doctor/finding.hpp"

namespace cartvo::doctor {

/// Texts of a finding, see there.
struct Observed {
  std::string seen;
  std::string expected = {};
  std::string advice = {};
};

/// Collects the findings of one area. Texts from outside are made printable and bounded.
class FindingList {
 public:
  explicit FindingList(std::string area) : area_(std::move(area)) {}

  /// Adds a finding; the advice is left out if it is ok.
  void add(std::string_view subject, Verdict verdict, const Observed& observed) {
    findings_.push_back({area_, printable(subject), verdict, printable(observed.seen),
                         printable(observed.expected),
                         verdict == Verdict::ok ? std::string() : printable(observed.advice)});
  }

  const std::string& area() const { return area_; }
  const Findings& findings() const { return findings_; }
  Findings take() { return std::move(findings_); }

 private:
  static std::string printable(std::string_view text) {
    constexpr std::size_t kMaxBytes = 1000;
    return printableExcerpt(text, kMaxBytes);
  }

  std::string area_;
  Findings findings_;
};

/// `otherwise` if not good.
constexpr Verdict okIf(bool is_good, Verdict otherwise) {
  return is_good ? Verdict::ok : otherwise;
}

}  // namespace cartvo::doctor
