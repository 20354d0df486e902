#pragma once

#include <filesystem>
#include <optional>

#include "calib/model/rig.hpp"
#include "daemon/service/configuration.hpp"
#include "tools/doctor/finding_list.hpp"

// Checks of the files that cartvod reads: configuration, rig file, passwords.

namespace cartvo::doctor {

/// Reads the configuration; nothing if it cannot be used, which is a finding.
std::optional<daemon::Configuration> checkConfiguration(const std::filesystem::path& file,
                                                        FindingList& findings);

/// Checks the odometry's settings.
void checkOdometrySettings(const vo::OdometrySettings& settings, FindingList& findings);

/// Reads the configured rig and checks it as checkRig does; nothing if it cannot be used.
std::optional<calib::Rig> checkRigFile(const daemon::Configuration& configuration, FindingList& findings);

/// Checks geometry, mount and readouts of a rig. `origin`: its file. False if it cannot be used.
bool checkRig(const calib::Rig& rig, const std::string& origin, FindingList& findings);

/// Checks that the camera's password can be read, and by whom. `side`: "left" or "right". True if there is a
/// usable password or none is needed. No finding holds the password.
bool checkPassword(const std::string& side, const daemon::CameraConfiguration& camera, FindingList& findings);

}  // namespace cartvo::doctor
