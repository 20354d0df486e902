#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tools/camera/camera_documents.hpp"
#include "tools/camera/settings_change.hpp"
#include "tools/camera/settings_check.hpp"

// Texts and JSON of `cartvo camera`.

namespace cartvo {

/// One camera of a report.
struct ReportedCamera {
  std::string side;                          ///< "left" or "right"
  std::string address;                       ///< "http://192.168.1.64:80"
  std::optional<CameraDocuments> documents;  ///< nothing: see `error`
  std::string error;                         ///< why it could not be read
};

using ReportedPair = std::vector<ReportedCamera>;

/// Identity and settings of the cameras.
std::string showText(const ReportedPair& cameras, const OdometryNeeds& needs);
nlohmann::json showJson(const ReportedPair& cameras, const OdometryNeeds& needs);

/// Comparison of the cameras with the needs of odometry, with the reasons.
struct CheckReport {
  ReportedPair const* cameras = nullptr;
  std::array<std::vector<Finding>, 2> findings;  ///< of left and right
  std::vector<std::string> differences;
  bool same_camera = false;  ///< both addresses lead to one camera

  bool isGood() const;
};

/// Checks those of the cameras that could be read.
CheckReport checkReport(const ReportedPair& cameras, const OdometryNeeds& needs);

/// `verbose`: also what is good.
std::string checkText(const CheckReport& report, bool verbose);
nlohmann::json checkJson(const CheckReport& report);

/// Lines "  wdr: open -> close".
std::string planText(const ReportedPair& cameras, const ChangePlan& plan);

/// Plan and result of `cartvo camera apply`. `results`: nothing for a camera that was not begun. `rest`:
/// the changes that are left to do; nothing if the cameras were not read again.
struct AppliedChanges {
  const ReportedPair* cameras = nullptr;
  const ChangePlan* plan = nullptr;
  std::array<std::optional<ApplyResult>, 2> results = {};
  std::optional<ChangePlan> rest = {};
};
nlohmann::json appliedJson(const AppliedChanges& applied);

/// The left and the right camera of the report; nothing for one that is missing or could not be read.
CameraPair pairOf(const ReportedPair& cameras);

/// "good", "wrong", "unlike", "unknown", "not reported".
std::string verdictText(Verdict verdict);

}  // namespace cartvo
