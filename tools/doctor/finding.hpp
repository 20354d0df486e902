#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cartvo::doctor {

/// Judgement of one thing that was looked at, from best to worst after `not_checked`.
enum class Verdict : std::uint8_t {
  not_checked,  ///< it could not be looked at, or not without disturbing a running cartvod; `advice` says how
  ok,
  look_at,  ///< cartvod works with it, but worse or not for long
  broken,   ///< cartvod does not work with it, or not safely
};

/// One line of the report. All texts are printable, complete phrases without a full stop, with units, and
/// never hold a credential. English, for people in the field.
struct Finding {
  std::string area;     ///< group of the line, for example "pictures"
  std::string subject;  ///< what was looked at, for example "left camera, exposure"
  Verdict verdict = Verdict::not_checked;
  std::string seen;      ///< what was seen, with numbers; why it was not checked
  std::string expected;  ///< what is expected; may be empty if `seen` says all
  std::string advice;    ///< what to do; empty if the verdict is ok
};

using Findings = std::vector<Finding>;

}  // namespace cartvo::doctor
