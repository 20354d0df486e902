#pragma once

#include <string>
#include <vector>

#include "tools/doctor/finding.hpp"
#include "tools/doctor/picture_pair.hpp"

namespace cartvo::doctor {

/// What the report is about.
struct ReportHead {
  std::string host;     ///< name of the computer
  std::string time;     ///< "2026-11-26 19:20:00 UTC"
  std::string version;  ///< of cartvo
  std::string source;   ///< the configuration, recording or sequence that was looked at
};

/// One self-contained HTML page for light and dark displays: the findings, and of the first pair both
/// pictures.
std::string htmlReport(const ReportHead& head, const Findings& findings,
                       const std::vector<PicturePair>& pictures);

}  // namespace cartvo::doctor
