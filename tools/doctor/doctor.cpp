// All checks of `cartvo doctor`, one after the other.
#include "tools/doctor/doctor.hpp"

#include <array>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <sys/resource.h>

#include "capture/recording/recording_folder.hpp"
#include "capture/rtsp/rtsp_url.hpp"
#include "daemon/service/configuration.hpp"
#include "tools/camera/camera_access.hpp"
#include "tools/camera/network/camera_ports.hpp"
#include "tools/doctor/cameras/camera_checks.hpp"
#include "tools/doctor/cameras/stream_checks.hpp"
#include "tools/doctor/cameras/stream_probe.hpp"
#include "tools/doctor/configuration_checks.hpp"
#include "tools/doctor/host_checks.hpp"
#include "tools/doctor/network/daemon_checks.hpp"
#include "tools/doctor/network/lcm_checks.hpp"
#include "tools/doctor/odometry_checks.hpp"
#include "tools/doctor/picture_checks.hpp"
#include "tools/doctor/recording_checks.hpp"

namespace cartvo::doctor {
namespace {

constexpr std::array<const char*, 2> kSides{"left", "right"};

/// Lowers the priority of this process, so that it takes no time from cartvod.
void yieldToOthers() {
  constexpr int kLowest = 19;
  ::setpriority(PRIO_PROCESS, 0, kLowest);
}

std::vector<PicturePair> picturesOf(const std::vector<capture::FramePair>& pairs) {
  std::vector<PicturePair> pictures;
  for (const capture::FramePair& pair : pairs)
    pictures.push_back({pair.left.image, pair.right.image, pair.left.exposure_ns, pair.right.exposure_ns});
  return pictures;
}

/// A run of all checks, with the state that they share.
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
  void examineRecordedStreams(const daemon::Configuration& configuration);
  void examineConfiguration();
  void examineComputer(const daemon::Configuration& configuration);
  LcmObservation examineLcm(const daemon::Configuration& configuration);
  void examineCameras(const daemon::Configuration& configuration, const std::array<bool, 2>& has_password,
                      const std::optional<health_t>& health);
  CameraAnswer askCamera(const daemon::Configuration& configuration, std::size_t side, bool has_password,
                         const std::optional<health_t>& health, FindingList& findings);
  void examineStreams(const daemon::Configuration& configuration, const std::array<CameraAnswer, 2>& cameras,
                      std::array<FindingList, 3>& areas);
  void examinePairs(const daemon::Configuration& configuration, const KeptPairs& pairs,
                    pipeline::AbsentReadout absent_readout);

  void step(const WorkStep& step) { observer_.work.begin(step); }
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
  bool cartvod_runs_ = false;
};

void Run::examineConfiguration() {
  FindingList files("files");
  const std::optional<daemon::Configuration> configuration = checkConfiguration(settings_.source, files);
  std::array<bool, 2> has_password{};
  if (configuration) {
    checkOdometrySettings(configuration->odometry, files);
    examination_.rig = checkRigFile(*configuration, files);
    has_password = {checkPassword("left", configuration->left, files),
                    checkPassword("right", configuration->right, files)};
  }
  finish(std::move(files));
  examineComputer(configuration.value_or(daemon::Configuration()));
  if (!configuration || isInterrupted()) return;
  const LcmObservation seen = examineLcm(*configuration);
  cartvod_runs_ = seen.health.has_value();
  if (cartvod_runs_) yieldToOthers();
  if (!isInterrupted()) examineCameras(*configuration, has_password, seen.health);
}

void Run::examineComputer(const daemon::Configuration& configuration) {
  FindingList computer("computer");
  checkComputer(settings_.proc, computer);
  checkReceiveBuffers(settings_.proc, configuration, computer);
  checkDisk(configuration, computer);
  checkKernelClock(readKernelClock(), servesTime(settings_.proc), computer);
  finish(std::move(computer));
}

LcmObservation Run::examineLcm(const daemon::Configuration& configuration) {
  constexpr std::chrono::milliseconds kDuration{2500};  // health comes once a second
  step({"listening to LCM"});
  LcmObservation seen = observeLcm(configuration.lcm_url, kDuration, interrupted_);
  FindingList messages("messages");
  checkLcm(configuration.lcm_url, seen, messages);
  finish(std::move(messages));
  FindingList running("cartvod");
  if (seen.health) {
    daemon::StatedReadouts readouts;
    if (examination_.rig) readouts = {examination_.rig->left.readout, examination_.rig->right.readout};
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
  if (!is_free) {
    findings.add("stream", Verdict::not_checked,
                 {"cartvod has it, and a camera may serve only one", "",
                  "stop cartvod, or use --streams if the camera serves a second stream"});
  }
  if (camera.isV4l2()) {
    answer.may_stream = is_free;
    return answer;
  }
  const bool is_received = known != nullptr && known->state == camera_health_t::STREAMING;
  answer.is_reachable = is_received || checkAddress(configuration, camera, interrupted_, findings);
  if (!answer.is_reachable) return answer;
  CameraQuestion question{settings_.access, LoginPermission::allowed};
  question.access.side = kSides[side];
  question.access.configuration = settings_.source;
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
  const std::optional<std::string> time_clients = chronyClients();
  for (std::size_t i = 0; i < answers.size() && !isInterrupted(); ++i) {
    step({fmt::format("asking the {} camera", kSides[i])});
    answers[i] = askCamera(configuration, i, has_password[i], health, areas[i]);
    const daemon::CameraConfiguration& camera = i == 0 ? configuration.left : configuration.right;
    if (time_clients && answers[i].is_reachable)
      checkTimeClient(capture::parseRtspUrl(camera.url).host, *time_clients, areas[i]);
  }
  OdometryNeeds needs;
  needs.frame_rate = configuration.frame_rate;
  addThisComputer(needs, configuration);
  if (examination_.rig) {
    needs.width = examination_.rig->left.size.width;
    needs.height = examination_.rig->left.size.height;
  }
  checkSettings({answers[0].documents ? &*answers[0].documents : nullptr,
                 answers[1].documents ? &*answers[1].documents : nullptr},
                needs, {areas.data(), &areas[1], &areas[2]});
  if (!isInterrupted()) examineStreams(configuration, answers, areas);
}

void Run::examineStreams(const daemon::Configuration& configuration,
                         const std::array<CameraAnswer, 2>& cameras, std::array<FindingList, 3>& areas) {
  const ProbeSettings probe_settings{{cameras[0].may_stream, cameras[1].may_stream},
                                     settings_.seconds,
                                     examination_.rig ? examination_.rig->left.size : cv::Size()};
  Probe probe;
  if (cameras[0].may_stream || cameras[1].may_stream) {
    step({fmt::format("measuring the streams for {:g} s", settings_.seconds), "s"});
    probe = probeStreams(configuration, probe_settings, observer_.work.progress, interrupted_);
  }
  const StreamNeeds needs{probe_settings.size, configuration.frame_rate};
  for (std::size_t i = 0; i < cameras.size() && !isInterrupted(); ++i) {
    if (cameras[i].may_stream) checkStream(probe.streams[i], needs, areas[i]);
  }
  if (!isInterrupted()) compareStreams(probe.streams, areas[2]);
  for (FindingList& area : areas)
    finish(std::move(area));
  if (cameras[0].may_stream && cameras[1].may_stream)
    examinePairs(configuration, probe.pairs, pipeline::AbsentReadout::unknown);
}

void Run::examinePairs(const daemon::Configuration& configuration, const KeptPairs& pairs,
                       pipeline::AbsentReadout absent_readout) {
  const std::optional<calib::Rig>& rig = examination_.rig;
  examination_.pictures = picturesOf(pairs.spread);
  if (isInterrupted()) return;
  step({"processing some pairs"});
  FindingList odometry("odometry");
  if (cartvod_runs_) {
    odometry.add("processing time", Verdict::not_checked,
                 {"cartvod uses the processors: see its own line", "", "stop cartvod to measure it"});
  } else if (rig) {
    checkProcessing(
        pairs.consecutive,
        {*rig, configuration.odometry, configuration.threads, absent_readout, configuration.alert_limits},
        observer_.work.progress, interrupted_, odometry);
  }
  finish(std::move(odometry));
  if (isInterrupted()) return;
  FindingList pictures("pictures");
  checkPictures(examination_.pictures, rig ? &*rig : nullptr, pictures);
  finish(std::move(pictures));
}

void Run::examineFolder() {
  FindingList source("source");
  daemon::Configuration configuration;
  const bool is_recording = capture::isRecording(settings_.source);
  if (is_recording) configuration = checkRecording(settings_.source, source).value_or(configuration);
  step({"reading pairs of the first two minutes", "s"});
  SourceContent content = readSource(settings_.source, observer_.work.progress, interrupted_, source);
  examination_.rig = std::move(content.rig);
  finish(std::move(source));
  FindingList computer("computer");
  checkComputer(settings_.proc, computer);
  finish(std::move(computer));
  if (is_recording) examineRecordedStreams(configuration);
  examinePairs(configuration, content.pairs, content.absent_readout);
}

void Run::examineRecordedStreams(const daemon::Configuration& configuration) {
  std::array<FindingList, 3> areas{FindingList("left camera"), FindingList("right camera"),
                                   FindingList("both cameras")};
  std::array<StreamMeasurement, 2> streams;
  const StreamNeeds needs{examination_.rig ? examination_.rig->left.size : cv::Size(),
                          configuration.frame_rate};
  for (std::size_t i = 0; i < streams.size(); ++i) {
    step({fmt::format("measuring the {} camera's recorded stream", kSides[i])});
    streams[i] = measureRecording(settings_.source, static_cast<capture::CameraSide>(i), settings_.seconds,
                                  interrupted_);
    if (!streams[i].pictures.empty()) checkStream(streams[i], needs, areas[i]);
  }
  compareStreams(streams, areas[2]);
  for (FindingList& area : areas)
    finish(std::move(area));
}

}  // namespace

Examination examine(const DoctorSettings& settings, const DoctorObserver& observer,
                    const std::atomic<bool>& interrupted) {
  return Run(settings, observer, interrupted).examineSource();
}

}  // namespace cartvo::doctor
