// All checks of `cartvo doctor`, one after the other.
#include "tools/doctor/doctor.hpp"

#include <utility>

#include "daemon/service/configuration.hpp"
#include "tools/doctor/configuration_checks.hpp"
#include "tools/doctor/host_checks.hpp"

namespace cartvo::doctor {
namespace {

/// One run of all checks.
class Run {
 public:
  Run(const DoctorSettings& settings, const DoctorObserver& observer, const std::atomic<bool>& interrupted)
      : settings_(settings), observer_(observer), interrupted_(interrupted) {}

  Examination examineConfiguration() {
    FindingList files("files");
    const std::optional<daemon::Configuration> configuration = checkConfiguration(settings_.source, files);
    if (configuration) {
      checkOdometrySettings(configuration->odometry, files);
      checkRigFile(*configuration, files);
      checkPassword("left", configuration->left, files);
      checkPassword("right", configuration->right, files);
    }
    finish(std::move(files));
    examineComputer(configuration.value_or(daemon::Configuration()));
    return std::move(examination_);
  }

 private:
  void examineComputer(const daemon::Configuration& configuration) {
    FindingList computer("computer");
    checkComputer(settings_.proc, configuration, computer);
    checkDisk(configuration, computer);
    checkKernelClock(readKernelClock(), servesTime(settings_.proc), computer);
    finish(std::move(computer));
  }

  void finish(FindingList list) {
    const Findings area = list.take();
    observer_.area(area);
    examination_.findings.insert(examination_.findings.end(), area.begin(), area.end());
  }

  const DoctorSettings& settings_;
  const DoctorObserver& observer_;
  const std::atomic<bool>& interrupted_;
  Examination examination_;
};

}  // namespace

Examination examine(const DoctorSettings& settings, const DoctorObserver& observer,
                    const std::atomic<bool>& interrupted) {
  return Run(settings, observer, interrupted).examineConfiguration();
}

}  // namespace cartvo::doctor
