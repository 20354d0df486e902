// Assembles cartvod from its parts and runs logging, health messages and watchdog.

#include "daemon/service/daemon.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core/utility.hpp>
#include <spdlog/spdlog.h>

#include "calib/format/rig_file.hpp"
#include "calib/rectification/rectification_tables.hpp"
#include "calib/rectification/rectifier.hpp"
#include "common/host_clock.hpp"
#include "common/image_size.hpp"
#include "daemon/diagnostics/camera_log.hpp"
#include "daemon/diagnostics/health_monitor.hpp"
#include "daemon/diagnostics/journal.hpp"
#include "daemon/diagnostics/log.hpp"
#include "daemon/diagnostics/measurement_checks.hpp"
#include "daemon/diagnostics/metrics_server.hpp"
#include "daemon/diagnostics/validity_log.hpp"
#include "daemon/page/status_page.hpp"
#include "daemon/publish/foreign_odometry.hpp"
#include "daemon/publish/lcm_connection.hpp"
#include "daemon/publish/message_sender.hpp"
#include "daemon/publish/odometry_publisher.hpp"
#include "daemon/publish/pose_publisher.hpp"
#include "daemon/service/camera_password.hpp"
#include "daemon/service/configuration_change.hpp"
#include "daemon/service/live_camera.hpp"
#include "daemon/service/live_recording.hpp"
#include "daemon/service/service_manager.hpp"
#include "pipeline/pipeline.hpp"

namespace cartvo::daemon {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kHealthPeriod{1};

calib::Rectifier loadRectifier(const calib::Rig& rig, const std::filesystem::path& tables_file) {
  const calib::RectificationSettings& settings = rig.rectification;
  if (tables_file.empty()) return {rig, settings, calib::buildTables(rig, settings)};
  calib::LoadedTables loaded = calib::loadOrBuildTables(rig, settings, tables_file);
  spdlog::info("rectification tables: {}", loaded.message);
  return {rig, settings, std::move(loaded.tables)};
}

/// `clock` stamps the frames and gets the odometry's estimate of the time offset; `page` shows each camera's
/// frames, unless it is nullptr: it may start while the cameras' readers run. `clock` must outlive the
/// pipeline, the page its runLive().
pipeline::PipelineSettings pipelineSettings(const calib::Rig& rig, capture::StereoTimestamper& clock,
                                            const std::atomic<StatusPage*>& page) {
  return {.image_size = rig.left.size,
          .set_visual_offset = [&clock](const auto& offset) { clock.setVisual(offset); },
          .frame =
              [&page](capture::CameraSide side, const capture::Frame& frame) {
                if (StatusPage* const shown = page) shown->addFrame(side, frame);
              }};
}

/// Reads the configured rig. Throws std::runtime_error that names the next step if there is none yet.
calib::Rig readConfiguredRig(const Configuration& configuration) {
  std::error_code error;
  if (std::filesystem::exists(configuration.rig, error) || error)
    return withConfiguredReadouts(calib::readRig(configuration.rig), configuration);
  throw std::runtime_error(
      configuration.rig.string() +
      ": does not exist; are the cameras not calibrated yet? 'cartvo calibrate' writes this "
      "file, which the key rig: of the configuration names");
}

}  // namespace

class Daemon::Implementation {
 public:
  explicit Implementation(const Configuration& configuration)
      : configuration_(configuration),
        rig_(readConfiguredRig(configuration)),
        reservation_(configuration.lcm_url),
        sender_(configuration.lcm_url),
        publisher_(sender_, configuration.time_to_live),
        foreign_(configuration.lcm_url, publisher_.sourceId()),
        recording_(configuration),
        clock_(configuration.clock),
        left_(configuration, capture::CameraSide::left, rig_.left.size, clock_),
        right_(configuration, capture::CameraSide::right, rig_.left.size, clock_),
        processor_(rig_, loadRectifier(rig_, configuration.tables),
                   {configuration.odometry, pipeline::AbsentReadout::unknown, configuration.alert_limits}),
        pipeline_(left_.source(), right_.source(), processor_, pipelineSettings(rig_, clock_, shown_page_)),
        pose_publisher_(sender_, configuration.pose_channel, configuration.pose_velocity),
        health_(Clock::now(), {rig_.left.readout, rig_.right.readout}),
        next_health_(Clock::now() + kHealthPeriod) {
    cv::setNumThreads(configuration.threads);
    spdlog::info("LCM: {}", describeLcmUrl(configuration.lcm_url));
    watchRoute();
    if (!calib::hasMount(rig_)) spdlog::warn("{}: {}", configuration.rig.string(), calib::kNoMountText);
    recording_.observe(left_, right_);
    startServers();
  }
  void run() {
    spdlog::info("cartvod " CARTVO_VERSION ": rig '{}', {}, baseline {:.1f} mm; left {}, right {}", rig_.name,
                 sizeText(rig_.left.size), 1e3 * rig_.baseline(), configuration_.left.url,
                 configuration_.right.url);
    service_.setStatus("waiting for both cameras");
    pipeline_.runLive({[this](const pipeline::PairResult& result) { onPair(result); },
                       [this](const pipeline::NoPair& no_pair) { onNoPair(no_pair); }});
    service_.notifyStopping();
    const pipeline::PipelineCounts counts = pipeline_.counts();
    spdlog::info("stopped after {} pairs, {} of them skipped to stay current", counts.pairs, counts.skipped);
  }
  void stop() noexcept { pipeline_.stop(); }
  void reload(const Configuration& next) {
    const std::lock_guard lock(reload_mutex_);
    reloaded_ = next;
  }

 private:
  /// Starts the servers that are configured and do not run yet. One that cannot listen is logged and tried
  /// again with each health message, because controllers need the motion: another program may leave the port,
  /// the address may come with a cable.
  void startServers() {
    try {
      if (configuration_.metrics && !metrics_) startMetrics();
    } catch (const std::exception& error) {
      warnings_.warn(std::string("no metrics are served yet: ") + error.what());
    }
    try {
      if (configuration_.page.listen && !page_) startPage();
    } catch (const std::exception& error) {
      warnings_.warn(std::string("the status page is not served yet: page.listen: ") + error.what() +
                     " As a service, another port than 9465 needs SocketBindAllow=");
    }
  }
  void startMetrics() {
    metrics_ = std::make_unique<MetricsServer>(*configuration_.metrics);
    spdlog::info("metrics: http://{}/metrics, /healthz, /readyz and /livez", metrics_->address());
  }
  /// Its buttons start and stop recordings.
  void startPage() {
    const PageServerSettings settings{*configuration_.page.listen, readPageToken(configuration_.page),
                                      PageControllers::token_holders};
    page_ = std::make_unique<StatusPage>(
        settings, rig_.name,
        RecordingControl{[this] { return recording_.start(); }, [this] { return recording_.stop(); }});
    processor_.setViewer(page_->viewer());
    shown_page_ = page_.get();
    spdlog::info("status page: {}", page_->url());
  }
  /// False as long as another publisher may not have been received yet. Throws std::runtime_error if there is
  /// one. Meanwhile the cameras connect.
  bool mayPublish() {
    if (is_sole_publisher_) return true;
    if (const std::string problem = foreign_.consumeProblem(); !problem.empty())
      throw std::runtime_error("not started: " + problem);
    is_sole_publisher_ = foreign_.hasListened();
    return is_sole_publisher_;
  }
  void onPair(const pipeline::PairResult& result) {
    if (!mayPublish()) return;
    const odometry_t& message = publisher_.publish(result);
    pose_publisher_.publish(message);
    health_.addPair(result, message);
    if (metrics_) metrics_->addPair(result, message);
    if (page_) page_->addPair(result, message);
    if (message.status == odometry_t::VALID) service_.notifyReady();
    validity_.log(message, result.exceedsAlertLimit() ? result.worst->text() : "");
    tick();
  }
  void onNoPair(const pipeline::NoPair& no_pair) {
    if (!mayPublish()) return;
    const odometry_t& message = publisher_.publish(no_pair);
    health_.addMissedPair();
    if (metrics_) metrics_->addMissedPair(message);
    if (page_) page_->addMissedPair(message);
    validity_.log(message, "");
    tick();
  }
  /// Runs once per odometry message, so at the frame rate even without pairs: feeds the watchdog, unless a
  /// reader is stalled, and publishes the health message when it is due. A stalled odometry starves the
  /// watchdog.
  void tick() {
    applyReload();
    const std::string stalled =
        pipeline_.progress().stalledReader(std::max(left_.readerTimeout(), right_.readerTimeout()));
    if (metrics_) metrics_->setStalled(stalled);
    if (page_) page_->setStalled(stalled);
    if (stalled.empty()) {
      service_.feedWatchdog();
    } else {
      warnings_.warn("the " + stalled + " makes no progress; systemd is asked to restart cartvod");
      service_.triggerWatchdog();
    }
    if (const auto now = Clock::now(); now >= next_health_) {
      publishHealth(now);
      next_health_ = std::max(next_health_ + kHealthPeriod, now);
    }
  }
  void applyReload() {
    std::unique_lock lock(reload_mutex_);
    const std::optional<Configuration> next = std::exchange(reloaded_, std::nullopt);
    lock.unlock();
    if (!next) return;
    compareConfigurations(configuration_, *next).logAndSetLevel(next->log_level);
    configuration_.time_to_live = next->time_to_live;
    configuration_.pose_channel = next->pose_channel;
    configuration_.pose_velocity = next->pose_velocity;
    configuration_.log_level = next->log_level;
    publisher_.setTimeToLive(next->time_to_live);
    pose_publisher_.setChannel(next->pose_channel, next->pose_velocity);
  }
  /// Network managers change routes while the daemon runs; LCM says nothing of that.
  void watchRoute() try {
    const MulticastRoute route = findMulticastRoute(configuration_.lcm_url);
    if (route_ && route_->interface == route.interface) return;
    if (route_) warnings_.forget(multicastWarning(*route_));
    route_ = route;
    if (route.interface.empty()) return;  // it is a problem, which is logged
    spdlog::info("LCM: the route for {} goes through {}", route.address, route.interface);
    if (const std::string warning = multicastWarning(route); !warning.empty()) warnings_.warn(warning);
  } catch (const std::system_error& error) {
    warnings_.warn(error.what());
  }
  void publishHealth(Clock::time_point now) {
    watchRoute();
    startServers();
    clock_.setHostClockCorrection(hostClockCorrection());
    const std::string foreign = foreign_.consumeProblem();
    HealthSnapshot snapshot;
    snapshot.left = left_.source().health();
    snapshot.right = right_.source().health();
    snapshot.counts = pipeline_.counts();
    snapshot.clock = clock_.status();
    snapshot.problem = foreign.empty() ? pipeline_.problem() : foreign;
    if (snapshot.problem.empty() && route_ && route_->interface.empty())
      snapshot.problem = multicastWarning(*route_);
    snapshot.features = configuration_.odometry.features;
    snapshot.recording = recording_.problem(warnings_);
    snapshot.frame_rate = frameRateProblem(snapshot.counts.periods, configuration_.frame_rate);
    snapshot.pairing = pipeline_.pairingProblem();
    if (!calib::hasMount(rig_)) snapshot.advice = calib::kNoMountText;
    const health_t message = health_.summarise(now, snapshot);
    sender_.publish(kHealthChannel, message);
    if (metrics_) metrics_->setHealth(message);
    if (page_) page_->setHealth(message, recording_.state());
    service_.setStatus(statusLine(message));
    left_log_.log(snapshot.left);
    right_log_.log(snapshot.right);
    for (const std::string& problem :
         {snapshot.problem, snapshot.clock.problem, snapshot.pairing, snapshot.recording, snapshot.frame_rate,
          health_.lightProblem(), snapshot.left.advice, snapshot.right.advice, snapshot.clock.advice}) {
      if (!problem.empty()) warnings_.warn(problem);
    }
    if (health_.selfCheck().consumeChange()) {
      const bool in_order = message.self_check.empty();
      logEvent(in_order ? spdlog::level::info : spdlog::level::warn,
               "self-check: " + (in_order ? "no error of the rig file or of the clocks is found any more"
                                          : message.self_check),
               {{"CARTVO_EVENT", "self_check"}, {"CARTVO_SELF_CHECK", in_order ? "passed" : "failed"}});
    }
    if (publisher_.failures() > reported_failures_) {
      warnings_.warn(
          fmt::format("LCM: messages could not be sent ({}); check the route with 'ip route get {}'",
                      sender_.error(), route_->address));
      reported_failures_ = publisher_.failures();
    }
  }
  std::string statusLine(const health_t& health) {
    if (!health.problem.empty()) return health.problem;
    if (std::string fault = health_.selfCheck().message(); !fault.empty()) return fault;
    if (!validity_.isValid() && !health.bound_exceeded.empty())
      return "no valid odometry: " + health.bound_exceeded;
    return fmt::format("{}, {:.1f} pairs/s, latency {:.1f} ms, offset {:.1f} ms, {} skipped",
                       validity_.isValid() ? "odometry valid" : "no valid odometry", health.pair_rate,
                       health.latency_p50_ms, health.offset_ms, health.pairs_skipped);
  }

  Configuration configuration_;
  std::mutex reload_mutex_;
  std::optional<Configuration> reloaded_;  ///< not applied yet
  calib::Rig rig_;
  ChannelReservation reservation_;
  GroupSender sender_;
  std::optional<MulticastRoute> route_;
  OdometryPublisher publisher_;
  ForeignOdometry foreign_;
  bool is_sole_publisher_ = false;
  LiveRecording recording_;  ///< must outlive the cameras, as the next
  capture::StereoTimestamper clock_;
  LiveCamera left_;
  LiveCamera right_;
  pipeline::PairProcessor processor_;
  std::atomic<StatusPage*> shown_page_ = nullptr;  ///< page_, for the cameras' readers
  pipeline::Pipeline pipeline_;
  PosePublisher pose_publisher_;
  HealthMonitor health_;
  std::unique_ptr<MetricsServer> metrics_;  ///< empty: not configured, as is the next
  std::unique_ptr<StatusPage> page_;
  ServiceManager service_;
  RepeatedWarnings warnings_;
  Clock::time_point next_health_;
  std::uint64_t reported_failures_ = 0;
  CameraLog left_log_{"left camera"};
  CameraLog right_log_{"right camera"};
  ValidityLog validity_;
};

Daemon::Daemon(const Configuration& configuration)
    : implementation_(std::make_unique<Implementation>(configuration)) {}
Daemon::~Daemon() = default;
void Daemon::run() {
  implementation_->run();
}
void Daemon::reload(const Configuration& next) {
  implementation_->reload(next);
}
void Daemon::stop() noexcept {
  implementation_->stop();
}

std::string configurationWarning(const Configuration& configuration) {
  return calib::hasMount(calib::readRig(configuration.rig)) ? "" : calib::kNoMountText;
}

void checkConfiguration(const Configuration& configuration) {
  const calib::Rig rig = readConfiguredRig(configuration);
  calib::computeRectification(rig, rig.rectification);
  vo::validate(configuration.odometry);
  for (const CameraConfiguration* camera : {&configuration.left, &configuration.right})
    readPassword(*camera);
  PageAccess(readPageToken(configuration.page), PageReaders::token_holders);
  parseLcmUrl(configuration.lcm_url);
}

}  // namespace cartvo::daemon
