#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "capture/isapi/isapi_client.hpp"
#include "tools/camera/settings_check.hpp"

// Changes settings of cameras to what odometry needs.

namespace cartvo {

/// Which settings are changed.
struct Selection {
  /// By name, with the value that the user wants; nothing: the best one.
  std::map<std::string, std::optional<std::string>> settings;
  bool all = false;  ///< also all others that are not as odometry needs them
};

/// One change of one camera.
struct Change {
  Setting setting;
  std::string from, to;
};

/// Changes that lead both cameras to the same good settings, and what cannot be changed.
struct ChangePlan {
  std::array<std::vector<Change>, 2> changes;
  std::array<std::vector<std::string>, 2> problems;  ///< "wdr: ..."

  bool isEmpty() const { return changes[0].empty() && changes[1].empty(); }
};

/// Why a name of the selection is no setting; empty if all are.
std::string nameProblem(const Selection& selection);

/// Plans changes. A setting that must be alike gets one value on both: the wanted one, else the best that
/// both offer, else the left camera's. Settings that are good and alike are left alone unless the user wants
/// another value. This computer as a time server is named to each camera by the address in its network.
/// Throws std::runtime_error for a name that is no setting.
ChangePlan planChanges(const CameraPair& cameras, const OdometryNeeds& needs, const Selection& selection);

/// How a change ended.
struct ChangeResult {
  Change change;
  bool is_taken = false;  ///< the camera reports the new value
  std::string problem;    ///< if it was not taken: what the camera reports or answers
};

struct ApplyResult {
  std::vector<ChangeResult> results;
  bool needs_reboot = false;  ///< the camera says that something takes effect only then
  std::string failure;        ///< why the changes ended early; empty if all were tried
};

/// Makes the changes, document by document, and reads each back. Each document is read anew, changed and
/// written as a whole, so that all other settings stay; what a firmware does not take so is written to its
/// sub-resource. Ends early, with `failure`, if the user may not write or the camera does not answer.
ApplyResult applyChanges(capture::IsapiClient& client, const CameraChannels& channels,
                         const std::vector<Change>& changes);

}  // namespace cartvo
