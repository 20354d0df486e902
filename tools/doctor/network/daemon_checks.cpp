// Checks of the state that a running cartvod reports.
#include "tools/doctor/network/daemon_checks.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <exception>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "capture/isapi/http_connection.hpp"
#include "daemon/diagnostics/measurement_checks.hpp"
#include "daemon/publish/message_names.hpp"

namespace cartvo::doctor {
namespace {

/// A text of the daemon that is empty if all is well, such as its problem.
void addText(const char* subject, const std::string& text, FindingList& findings) {
  findings.add(
      subject, okIf(text.empty(), Verdict::look_at),
      {text.empty() ? "none" : text, "none", "see /usr/share/doc/cartvo/troubleshooting.md for this text"});
}

void checkSpeed(const health_t& health, FindingList& findings) {
  if (!(health.process_ms >= 0.0F)) {
    findings.add("processing", Verdict::not_checked, {"no pair was processed in the last second"});
    return;
  }
  constexpr double kMaxLatency_ms = 100.0;
  const bool is_reduced = health.features_least < health.features_configured;
  findings.add(
      "processing", okIf(!is_reduced && health.latency_p99_ms < kMaxLatency_ms, Verdict::look_at),
      {fmt::format("{:.1f} ms a pair at {:.1f} pairs/s, latency {:.0f} ms (99 %), {} of {} features, "
                   "{} pairs skipped since the start",
                   health.process_ms, health.pair_rate, health.latency_p99_ms, health.features_least,
                   health.features_configured, health.pairs_skipped),
       fmt::format("latency below {:.0f} ms, all features", kMaxLatency_ms),
       "stop other programs, or lower odometry.features"});
}

/// A frozen camera is a fault; a loss of tracking may be the place.
void checkOdometryState(const health_t& health, FindingList& findings) {
  const bool measures =
      health.odometry_state == health_t::TRACKING || health.odometry_state == health_t::STANDSTILL;
  const Verdict verdict = health.odometry_state == health_t::LOST ? Verdict::look_at : Verdict::broken;
  findings.add("odometry", okIf(measures, verdict),
               {daemon::odometryStateName(health.odometry_state), "tracking or standstill",
                "a frozen camera: uncover its lens, or switch it off and on; lost: see "
                "/usr/share/doc/cartvo/troubleshooting.md for the reasons"});
}

void checkOffset(const health_t& health, const daemon::Configuration& configuration, FindingList& findings) {
  const double limit_ms = 1e3 * configuration.odometry.validity.maximum_offset_uncertainty;
  if (std::isnan(health.offset_ms) || std::isnan(health.clock_deviation_ms)) {
    findings.add("time offset", Verdict::not_checked, {"no pair was processed in the last second"});
    return;
  }
  findings.add(
      "time offset", okIf(health.clock_deviation_ms <= limit_ms, Verdict::broken),
      {fmt::format("{:+.1f} ms, standard deviation {:.1f} ms", health.offset_ms, health.clock_deviation_ms),
       fmt::format("a standard deviation of {:.0f} ms or less", limit_ms),
       "give both cameras one time server and the same settings"});
}

void checkEstimatedReadouts(const health_t& health, const daemon::StatedReadouts& rig_readouts,
                            FindingList& findings) {
  constexpr double kMillisecond = 1e-3;
  if (!(health.left_readout_deviation_ms > 0.0F && health.right_readout_deviation_ms > 0.0F)) {
    findings.add("readouts while driving", Verdict::not_checked, {"not estimated yet"});
    return;
  }
  daemon::ReadoutCheck check(rig_readouts);
  vo::ReadoutEstimates estimates;
  estimates.left = {kMillisecond * health.left_readout_ms, kMillisecond * health.left_readout_deviation_ms};
  estimates.right = {kMillisecond * health.right_readout_ms,
                     kMillisecond * health.right_readout_deviation_ms};
  check.update(estimates);
  const std::string message = check.message();
  findings.add("readouts while driving", okIf(message.empty(), Verdict::look_at),
               {message.empty() ? fmt::format("left {:.1f} ± {:.1f} ms, right {:.1f} ± {:.1f} ms",
                                              health.left_readout_ms, health.left_readout_deviation_ms,
                                              health.right_readout_ms, health.right_readout_deviation_ms)
                                : message,
                "as the rig file says, else the same for both", "cartvo calibrate readout"});
}

const char* stateText(int state) {
  switch (state) {
    case camera_health_t::CONNECTING:
      return "not connected";
    case camera_health_t::STREAMING:
      return "streaming";
    case camera_health_t::STALLED:
      return "stalled";
    case camera_health_t::REFUSED:
      return "refuses the login";
    case camera_health_t::FROZEN:
      return "frozen";
    default:
      return "ended";
  }
}

void checkReceivedRate(const camera_health_t& camera, const daemon::Configuration& configuration,
                       FindingList& findings) {
  constexpr double kTolerance = 1.5;  // Hz: the frames of one second are counted
  const double expected = configuration.frame_rate.value_or(camera.frame_rate);
  findings.add("frame rate", okIf(std::abs(camera.frame_rate - expected) <= kTolerance, Verdict::look_at),
               {fmt::format("{:.1f} Hz in the last second, by cartvod", camera.frame_rate),
                fmt::format("{:g} Hz", expected),
                "set the rate of both cameras: cartvo camera apply frame-rate; measure it with --streams"});
}

/// Names frames that were received and are in no pair, by the reason.
void checkPairing(const health_t& health, FindingList& findings) {
  constexpr double kMaxLeftOut = 0.01;  // share of the frames
  const std::array<std::pair<const char*, std::int64_t>, 6> reasons{
      {{"without a partner", health.dropped_no_partner},
       {"damaged", health.dropped_damaged},
       {"out of order", health.dropped_out_of_order},
       {"beyond the buffer", health.dropped_overflow},
       {"from before a clock was set back", health.dropped_clock},
       {"of another size", health.refused_size}}};
  std::int64_t left_out = 0;
  std::string seen;
  for (const auto& [words, count] : reasons) {
    left_out += count;
    if (count > 0) seen += fmt::format("{}{} {}", seen.empty() ? "" : ", ", count, words);
  }
  const std::int64_t frames = health.left.frames + health.right.frames;
  findings.add(
      "pairing",
      okIf(static_cast<double>(left_out) <= kMaxLeftOut * static_cast<double>(frames), Verdict::look_at),
      {fmt::format("frames in no pair since cartvod started: {} of {}{}", left_out, frames,
                   seen.empty() ? "" : " (" + seen + ")"),
       "at most one of 100", "set one frame rate and one time server for both cameras; see 'losses'"});
}

}  // namespace

void checkHealth(const health_t& health, const daemon::Configuration& configuration,
                 const daemon::StatedReadouts& rig_readouts, FindingList& findings) {
  const bool same_release = health.version == CARTVO_VERSION;
  findings.add(
      "release", okIf(same_release, Verdict::look_at),
      {fmt::format("{}, runs for {:.0f} s", health.version, 1e-6 * static_cast<double>(health.uptime_us)),
       CARTVO_VERSION, "restart cartvod after an update"});
  addText("problem", health.problem, findings);
  addText("self-check", health.self_check, findings);
  addText("alert limits", health.bound_exceeded, findings);
  checkOdometryState(health, findings);
  checkSpeed(health, findings);
  checkPairing(health, findings);
  checkOffset(health, configuration, findings);
  checkEstimatedReadouts(health, rig_readouts, findings);
}

void checkCameraHealth(const camera_health_t& camera, const daemon::Configuration& configuration,
                       FindingList& findings) {
  const bool is_streaming = camera.state == camera_health_t::STREAMING;
  findings.add("connection", okIf(is_streaming, Verdict::broken),
               {std::string(stateText(camera.state)) + ", by cartvod" +
                    (is_streaming || camera.last_error.empty() ? "" : ": " + camera.last_error),
                "streaming", "as the text says; /usr/share/doc/cartvo/troubleshooting.md has more"});
  if (!is_streaming) return;
  checkReceivedRate(camera, configuration, findings);
  constexpr double kMaxDamaged = 0.001;  // share of the frames
  const double damaged =
      static_cast<double>(camera.damaged) / std::max(1.0, static_cast<double>(camera.frames));
  findings.add("losses", okIf(damaged <= kMaxDamaged, Verdict::look_at),
               {fmt::format("{} of {} frames damaged, {} reconnections since cartvod started", camera.damaged,
                            camera.frames, camera.reconnections),
                "at most one of 1000 damaged", "cameras.transport: tcp; repair cable, switch or radio link"});
  findings.add(
      "clock", okIf(camera.clock_steps == 0, Verdict::look_at),
      {fmt::format("set {} times on this connection, skew {:+.0f} ppm", camera.clock_steps, camera.skew_ppm),
       "never set by a jump", "give the camera a time server that it reaches, with the shortest interval"});
}

void checkHealthPage(const daemon::Configuration& configuration, const std::atomic<bool>& interrupted,
                     FindingList& findings) {
  if (!configuration.metrics) return;
  constexpr std::chrono::seconds kTimeout{3};
  constexpr int kOk = 200;
  try {
    capture::HttpConnection connection({configuration.metrics->address, configuration.metrics->port, false},
                                       kTimeout);
    connection.setInterruption(interrupted);
    const capture::HttpResponse response = connection.send({.path = "/healthz"});
    std::string line = response.body.substr(0, response.body.find('\n'));
    findings.add("/healthz", okIf(response.status == kOk, Verdict::look_at),
                 {fmt::format("{} {}", response.status, line), "200", "as the line says"});
  } catch (const capture::HttpError& error) {
    findings.add("/healthz", Verdict::look_at,
                 {error.what(), "an answer of cartvod at " + configuration.metrics->text(),
                  "restart cartvod if metrics.listen was changed"});
  }
}

}  // namespace cartvo::doctor
