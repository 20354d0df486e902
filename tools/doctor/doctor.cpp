// All checks of `cartvo doctor`, one after the other.
#include "tools/doctor/doctor.hpp"

#include <algorithm>
#include <array>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "capture/recording/recording_folder.hpp"
#include "daemon/service/configuration.hpp"
#include "tools/camera/camera_access.hpp"
#include "tools/doctor/cameras/camera_checks.hpp"
#include "tools/doctor/cameras/stream_checks.hpp"
#include "tools/doctor/cameras/stream_probe.hpp"
#include "tools/doctor/configuration_checks.hpp"
#include "tools/doctor/host_checks.hpp"
#include "tools/doctor/network/daemon_checks.hpp"
#include "tools/doctor/network/lcm_checks.hpp"
#include "tools/doctor/odometry_checks.hpp"
#include "tools/doctor/recording_checks.hpp"

namespace cartvo::doctor {
namespace {

constexpr std::array<const char*, 2> kSides{"left", "right"};

/// A few of the pairs, evenly spread.
std::vector<PicturePair> somePictures(const std::vector<capture::FramePair>& pairs) {
  constexpr std::size_t kMax = 5;
  std::vector<PicturePair> pictures;
  const std::size_t count = std::min(kMax, pairs.size());
  for (std::size_t i = 0; i < count; ++i) {
    const capture::FramePair& pair = pairs[i * pairs.size() / count];
    pictures.push_back({pair.left.image, pair.right.image, pair.left.exposure_ns, pair.right.exposure_ns});
  }
  return pictures;
}

/// What the checks share.
class Run {
 public:
  Run(const DoctorSettings& settings, const DoctorObserver& observer, const std::atomic<bool>& interrupted)
      : settings_(settings), observer_(observer), interrupted_(interrupted) {}

  Examination examineSource() {
    std::error_code error;
    if (std::filesystem::is_directory(settings_.source, error)) {
      examineFolder();
    } else {
      examineConfiguration();
    }
    return std::move(examination_);
  }

 private:
  void examineFolder();
  void examineConfiguration();
  void examineComputer(const daemon::Configuration& configuration);
  LcmObservation examineLcm(const daemon::Configuration& configuration);
  void examineCameras(const daemon::Configuration& configuration, const std::array<bool, 2>& has_password,
                      const std::optional<health_t>& health);
  CameraAnswer askCamera(const daemon::Configuration& configuration, std::size_t side, bool has_password,
                         const std::optional<health_t>& health, FindingList& findings);
  void examineStreams(const daemon::Configuration& configuration, const std::array<CameraAnswer, 2>& cameras,
                      std::array<FindingList, 3>& areas);
  void examineOdometry(const daemon::Configuration& configuration,
                       const std::vector<capture::FramePair>& pairs, daemon::AbsentReadout absent_readout);

  void step(const std::string& text) { observer_.step(text); }
  bool isInterrupted() const { return interrupted_; }

  /// Reports the findings of an area, unless there are none.
  void finish(FindingList list) {
    const Findings area = list.take();
    if (area.empty()) return;
    observer_.area(area);
    examination_.findings.insert(examination_.findings.end(), area.begin(), area.end());
  }

  const DoctorSettings& settings_;
  const DoctorObserver& observer_;
  const std::atomic<bool>& interrupted_;
  Examination examination_;
  std::optional<calib::Rig> rig_;
};

void Run::examineConfiguration() {
  FindingList files("files");
  const std::optional<daemon::Configuration> configuration = checkConfiguration(settings_.source, files);
  std::array<bool, 2> has_password{};
  if (configuration) {
    checkOdometrySettings(configuration->odometry, files);
    rig_ = checkRigFile(*configuration, files);
    has_password = {checkPassword("left", configuration->left, files),
                    checkPassword("right", configuration->right, files)};
  }
  finish(std::move(files));
  examineComputer(configuration.value_or(daemon::Configuration()));
  if (!configuration || isInterrupted()) return;
  const LcmObservation seen = examineLcm(*configuration);
  if (!isInterrupted()) examineCameras(*configuration, has_password, seen.health);
}

void Run::examineComputer(const daemon::Configuration& configuration) {
  FindingList computer("computer");
  checkComputer(settings_.proc, configuration, computer);
  checkDisk(configuration, computer);
  checkKernelClock(readKernelClock(), servesTime(settings_.proc), computer);
  finish(std::move(computer));
}

LcmObservation Run::examineLcm(const daemon::Configuration& configuration) {
  constexpr std::chrono::milliseconds kDuration{2500};  // health comes once a second
  step("listening to LCM");
  LcmObservation seen = observeLcm(configuration.lcm_url, kDuration, interrupted_);
  FindingList messages("messages");
  checkLcm(configuration.lcm_url, seen, messages);
  finish(std::move(messages));
  FindingList running("cartvod");
  if (seen.health) {
    daemon::StatedReadouts readouts;
    if (rig_) readouts = {rig_->left.readout, rig_->right.readout};
    checkHealth(*seen.health, configuration, readouts, running);
    checkHealthPage(configuration, interrupted_, running);
  } else {
    running.add("service", Verdict::not_checked,
                {"no health message came: cartvod does not run, or with another lcm.url", "",
                 "systemctl status cartvod"});
  }
  finish(std::move(running));
  return seen;
}

CameraAnswer Run::askCamera(const daemon::Configuration& configuration, std::size_t side, bool has_password,
                            const std::optional<health_t>& health, FindingList& findings) {
  const daemon::CameraConfiguration& camera = side == 0 ? configuration.left : configuration.right;
  CameraAnswer answer;
  const camera_health_t* known = nullptr;
  if (health) known = side == 0 ? &health->left : &health->right;
  if (known != nullptr) checkCameraHealth(*known, configuration, findings);
  const bool is_free = known == nullptr || settings_.streams;
  if (camera.isV4l2()) {
    answer.may_stream = is_free;
    return answer;
  }
  const bool is_received = known != nullptr && known->state == camera_health_t::STREAMING;
  answer.is_reachable = is_received || checkAddress(configuration, camera, interrupted_, findings);
  if (!answer.is_reachable) return answer;
  CameraQuestion question{kSides[side], settings_.http_port, LoginPermission::allowed};
  if (!has_password) question.login = LoginPermission::no_password;
  if (known != nullptr && known->state == camera_health_t::REFUSED)
    question.login = LoginPermission::refused_already;
  askSettings(configuration, question, interrupted_, answer, findings);
  answer.may_stream = is_free && !answer.is_refused && question.login == LoginPermission::allowed;
  return answer;
}

void Run::examineCameras(const daemon::Configuration& configuration, const std::array<bool, 2>& has_password,
                         const std::optional<health_t>& health) {
  std::array<FindingList, 3> areas{FindingList("left camera"), FindingList("right camera"),
                                   FindingList("both cameras")};
  std::array<CameraAnswer, 2> answers;
  for (std::size_t i = 0; i < answers.size() && !isInterrupted(); ++i) {
    step(fmt::format("asking the {} camera", kSides[i]));
    answers[i] = askCamera(configuration, i, has_password[i], health, areas[i]);
  }
  OdometryNeeds needs;
  needs.frame_rate = configuration.frame_rate;
  if (rig_) {
    needs.width = rig_->left.size.width;
    needs.height = rig_->left.size.height;
  }
  checkSettings({answers[0].documents ? &*answers[0].documents : nullptr,
                 answers[1].documents ? &*answers[1].documents : nullptr},
                needs, {areas.data(), &areas[1], &areas[2]});
  if (!isInterrupted()) examineStreams(configuration, answers, areas);
}

void Run::examineStreams(const daemon::Configuration& configuration,
                         const std::array<CameraAnswer, 2>& cameras, std::array<FindingList, 3>& areas) {
  const ProbeSettings probe_settings{
      {cameras[0].may_stream, cameras[1].may_stream}, settings_.seconds, rig_ ? rig_->left.size : cv::Size()};
  Probe probe;
  if (cameras[0].may_stream || cameras[1].may_stream) {
    step(fmt::format("measuring the streams for {:g} s", settings_.seconds));
    probe = probeStreams(configuration, probe_settings, interrupted_);
  }
  const StreamNeeds needs{probe_settings.size, configuration.frame_rate};
  for (std::size_t i = 0; i < cameras.size() && !isInterrupted(); ++i) {
    if (cameras[i].may_stream) checkStream(probe.streams[i], needs, areas[i]);
  }
  if (!isInterrupted()) compareStreams(probe.streams, areas[2]);
  for (FindingList& area : areas)
    finish(std::move(area));
  if (cameras[0].may_stream && cameras[1].may_stream)
    examineOdometry(configuration, probe.pairs, daemon::AbsentReadout::unknown);
}

void Run::examineOdometry(const daemon::Configuration& configuration,
                          const std::vector<capture::FramePair>& pairs,
                          daemon::AbsentReadout absent_readout) {
  examination_.pictures = somePictures(pairs);
  if (!rig_ || isInterrupted()) return;
  FindingList odometry("odometry");
  step("processing some pairs");
  checkProcessing(pairs, {*rig_, configuration.odometry, configuration.threads, absent_readout}, interrupted_,
                  odometry);
  finish(std::move(odometry));
}

void Run::examineFolder() {
  FindingList source("source");
  daemon::Configuration configuration;
  const bool is_recording = capture::isRecording(settings_.source);
  if (is_recording) configuration = checkRecording(settings_.source, source).value_or(configuration);
  SourceContent content = readSource(settings_.source, interrupted_, source);
  rig_ = std::move(content.rig);
  finish(std::move(source));
  examineComputer(daemon::Configuration());
  if (is_recording) {
    std::array<FindingList, 3> areas{FindingList("left camera"), FindingList("right camera"),
                                     FindingList("both cameras")};
    std::array<StreamMeasurement, 2> streams;
    const StreamNeeds needs{rig_ ? rig_->left.size : cv::Size(), configuration.frame_rate};
    for (std::size_t i = 0; i < streams.size(); ++i) {
      streams[i] = measureRecording(settings_.source, static_cast<capture::CameraSide>(i), settings_.seconds,
                                    interrupted_);
      if (!streams[i].pictures.empty()) checkStream(streams[i], needs, areas[i]);
    }
    compareStreams(streams, areas[2]);
    for (FindingList& area : areas)
      finish(std::move(area));
  }
  examineOdometry(configuration, content.pairs, content.absent_readout);
}

}  // namespace

Examination examine(const DoctorSettings& settings, const DoctorObserver& observer,
                    const std::atomic<bool>& interrupted) {
  return Run(settings, observer, interrupted).examineSource();
}

}  // namespace cartvo::doctor
