#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "calib/model/rig.hpp"
#include "tools/doctor/finding.hpp"
#include "tools/doctor/picture_pair.hpp"

// Texts, JSON and HTML of findings.

namespace cartvo::doctor {

/// Subject of the report: the computer, the time, the program and the source.
struct ReportHead {
  std::string host;     ///< name of the computer
  std::string time;     ///< "2026-11-26 19:20:00 UTC"
  std::string version;  ///< of cartvo
  std::string source;   ///< the configuration, recording or sequence that was looked at
};

struct VerdictNames {
  const char* text;       ///< "look at"
  const char* key;        ///< in JSON
  const char* css_class;  ///< in HTML
};
const VerdictNames& namesOf(Verdict verdict);

/// The worst verdict; ok if nothing was checked.
Verdict worstVerdict(const Findings& findings);

/// Lines of one area: its name, and of each finding verdict, subject and what was seen; below a finding that
/// is not ok what is expected and what to do.
std::string areaText(const Findings& findings);

/// "2 broken, 1 to look at, 31 ok, 4 not checked".
std::string countsText(const Findings& findings);

/// The findings that are broken or to look at, worst first.
Findings bySeverity(const Findings& findings);

/// "broken: left camera, login" and "look at: ...", a line for each verdict that has findings.
std::string namesText(const Findings& findings);

nlohmann::ordered_json findingsJson(const ReportHead& head, const Findings& findings);

/// One self-contained HTML page for light and dark displays: what is broken, what is to look at,
/// all findings by area (folded), and of the middle pair both
/// pictures and, with a `rig` (may be nullptr), their rectified overlay.
std::string htmlReport(const ReportHead& head, const Findings& findings,
                       const std::vector<PicturePair>& pictures, const calib::Rig* rig);

}  // namespace cartvo::doctor
