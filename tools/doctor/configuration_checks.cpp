// Checks of the files that cartvod reads.
#include "tools/doctor/configuration_checks.hpp"

#include <cmath>
#include <exception>
#include <system_error>

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "calib/format/rig_file.hpp"
#include "calib/rectification/rectification.hpp"
#include "common/image_size.hpp"
#include "daemon/service/camera_password.hpp"

namespace cartvo::doctor {
namespace {

constexpr double kReadoutTolerance = 0.5e-3;  // s, as the self-check's

std::string readoutText(const std::optional<double>& readout) {
  return readout ? fmt::format("{:.1f} ms", 1e3 * *readout) : "not stated";
}

void checkReadouts(const calib::Rig& rig, FindingList& findings) {
  const std::optional<double>&left = rig.left.readout, &right = rig.right.readout;
  const std::string seen = "left " + readoutText(left) + ", right " + readoutText(right);
  const std::string expected = "the same for two cameras of one model and setting, or not stated for both";
  if (!left && !right) {
    findings.add("readouts", Verdict::ok, {seen + ": estimated while driving", expected});
    return;
  }
  const bool agree = left && right && std::abs(*left - *right) <= kReadoutTolerance;
  findings.add("readouts", okIf(agree, Verdict::look_at),
               {seen, expected,
                "measure both with cartvo calibrate readout, or remove readout from the rig file and the "
                "configuration: it is then estimated"});
}

/// Why a rig cannot be rectified; empty if it can.
std::string rectificationProblem(const calib::Rig& rig) {
  try {
    calib::computeRectification(rig, rig.rectification);
    return {};
  } catch (const std::exception& error) {
    return error.what();
  }
}

bool mayExist(const std::filesystem::path& file) {
  std::error_code error;
  return std::filesystem::exists(file, error) || error;
}

/// The password's file and its permissions.
struct PasswordFile {
  std::string name;
  mode_t mode = 0;

  /// Who beside the owner has access; empty if the owner alone.
  std::string others() const {
    if ((mode & S_IRWXO) != 0) return "all users";
    return (mode & S_IRWXG) != 0 ? "its group" : "";
  }
  std::string text() const { return fmt::format("{}, mode {:03o}", name, mode & 0777U); }
};

/// Nothing if there is no such file.
std::optional<PasswordFile> findPasswordFile(const daemon::CameraConfiguration& camera) {
  try {
    const std::filesystem::path file = daemon::passwordFile(camera);
    struct stat status {};
    if (::stat(file.c_str(), &status) != 0) return std::nullopt;
    return PasswordFile{file.string(), status.st_mode};
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

/// Why the password cannot be read; empty if it can.
std::string passwordProblem(const daemon::CameraConfiguration& camera) {
  try {
    daemon::readPassword(camera);
    return {};
  } catch (const std::exception& error) {
    return error.what();
  }
}

}  // namespace

std::optional<daemon::Configuration> checkConfiguration(const std::filesystem::path& file,
                                                        FindingList& findings) {
  try {
    daemon::Configuration configuration = daemon::readConfiguration(file);
    findings.add("configuration", Verdict::ok, {file.string() + ": in order"});
    return configuration;
  } catch (const std::exception& error) {
    findings.add("configuration", Verdict::broken,
                 {error.what(), "a configuration of cartvod",
                  "correct the file; cartvod.yaml(5) explains each key; without it nothing about cameras can "
                  "be checked"});
    return std::nullopt;
  }
}

void checkOdometrySettings(const vo::OdometrySettings& settings, FindingList& findings) {
  const bool is_default = settings.estimator != vo::Estimator::thesis;
  findings.add("estimator", okIf(is_default, Verdict::look_at),
               {is_default ? "reprojection" : "thesis, which treats both pictures as simultaneous",
                "reprojection", "remove odometry.estimator from the configuration"});
}

std::optional<calib::Rig> checkRigFile(const daemon::Configuration& configuration, FindingList& findings) {
  if (!mayExist(configuration.rig)) {
    findings.add("rig", Verdict::broken,
                 {configuration.rig.string() + " does not exist", "the rig file of these two cameras",
                  "calibrate with cartvo calibrate live, or copy the rig file there"});
    return std::nullopt;
  }
  try {
    calib::Rig rig = daemon::withConfiguredReadouts(calib::readRig(configuration.rig), configuration);
    if (!checkRig(rig, configuration.rig.string(), findings)) return std::nullopt;
    return rig;
  } catch (const std::exception& error) {
    findings.add("rig", Verdict::broken,
                 {error.what(), "the rig file of these two cameras", "correct the rig file, or calibrate"});
    return std::nullopt;
  }
}

bool checkRig(const calib::Rig& rig, const std::string& origin, FindingList& findings) {
  const std::string problem = rectificationProblem(rig);
  findings.add("rig", okIf(problem.empty(), Verdict::broken),
               {problem.empty() ? fmt::format("{}: '{}', {}, baseline {:.1f} mm", origin, rig.name,
                                              sizeText(rig.left.size), 1e3 * rig.baseline())
                                : origin + ": " + problem,
                "the rig of these two cameras, which can be rectified", "calibrate again"});
  if (!problem.empty()) return false;
  const bool has_mount = calib::hasMount(rig);
  findings.add("mount on the cart", okIf(has_mount, Verdict::look_at),
               {has_mount ? fmt::format("left camera at height {:.2f} m", rig.T_body_camera.translation().z())
                          : "not stated: velocities are the left camera's",
                "T_body_camera in the rig file", "cartvo calibrate mount"});
  checkReadouts(rig, findings);
  return true;
}

bool checkPassword(const std::string& side, const daemon::CameraConfiguration& camera,
                   FindingList& findings) {
  const std::string subject = side + " camera's password";
  if (camera.isV4l2()) return true;
  if (camera.username.empty()) {
    findings.add(subject, Verdict::ok, {"no user name: cartvod sends no password"});
    return true;
  }
  const std::string problem = passwordProblem(camera);
  const std::optional<PasswordFile> file = findPasswordFile(camera);
  if (file && !file->others().empty()) {
    findings.add(subject, Verdict::broken,
                 {file->text() + ": " + file->others() + " can read the password", "mode 600 or less",
                  "chmod 600 " + file->name +
                      ", with the user that runs cartvod as its owner (root for a credential); if others use "
                      "this computer, change the camera's password"});
  } else if (problem.empty()) {
    findings.add(subject, Verdict::ok, {file->text(), "mode 600 or less"});
  } else if (::geteuid() != 0) {
    findings.add(subject, Verdict::not_checked, {problem, "", "run cartvo doctor as root"});
  } else {
    findings.add(subject, Verdict::broken,
                 {problem, "a file of one line that its owner alone can read",
                  "write the camera's password into this file, mode 600"});
  }
  return problem.empty();
}

}  // namespace cartvo::doctor
