// Judges measured streams.
#include "tools/doctor/cameras/stream_checks.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "common/image_size.hpp"
#include "common/statistics.hpp"

namespace cartvo::doctor {
namespace {

constexpr double kPercent = 100.0, kMilliseconds = 1e3, kKilobit = 1e3;
constexpr double kRateTolerance = 0.001;   // relative
constexpr double kSignificance = 3.0;      // standard deviations
constexpr double kFastestLatency = -0.02;  // s, of a camera whose clock is right
constexpr double kSlowestLatency = 1.0;    // s

void checkSize(const StreamMeasurement& measurement, const StreamNeeds& needs, FindingList& findings) {
  const bool fits = needs.size.empty() || measurement.size == needs.size;
  findings.add(
      "size", okIf(fits, Verdict::broken),
      {sizeText(measurement.size), needs.size.empty() ? "any" : sizeText(needs.size) + ", as the rig",
       "set the size of the rig file in the camera, or calibrate at this size"});
}

std::string rateText(const StreamStatistics& statistics) {
  if (statistics.host_rate <= 0.0) return fmt::format("{:.3f} Hz", statistics.rate);
  return fmt::format("{:.3f} Hz by the camera's clock, {:.3f} ± {:.3f} Hz by this computer's",
                     statistics.rate, statistics.host_rate, statistics.host_rate_stddev);
}

/// Whether a rate (Hz) is the expected one, within its standard deviation (Hz).
bool isRate(double rate, double stddev, double expected) {
  return std::abs(rate - expected) <= kRateTolerance * expected + kSignificance * stddev;
}

void checkRate(const StreamStatistics& statistics, const StreamNeeds& needs, FindingList& findings) {
  if (statistics.rate <= 0.0) {
    findings.add("frame rate", Verdict::not_checked,
                 {"too few pictures to measure it", "", "raise --seconds"});
    return;
  }
  const bool by_host = statistics.host_rate > 0.0;
  const double rate = by_host ? statistics.host_rate : statistics.rate;
  const bool fits = !needs.frame_rate || isRate(rate, statistics.host_rate_stddev, *needs.frame_rate);
  findings.add(
      "frame rate", okIf(fits, Verdict::look_at),
      {rateText(statistics),
       needs.frame_rate ? fmt::format("{:g} Hz to {:.1f} %, as cameras.frame_rate", *needs.frame_rate,
                                      kPercent * kRateTolerance)
                        : "the same on both cameras",
       "set this rate in the camera (cartvo camera apply frame-rate), or correct cameras.frame_rate"});
  if (!by_host) return;
  const bool agrees = isRate(statistics.host_rate, statistics.host_rate_stddev, statistics.rate);
  findings.add("pace", okIf(agrees, Verdict::broken),
               {fmt::format("RTP time advances {:.4f} s in a second",
                            statistics.rate > 0.0 ? statistics.host_rate / statistics.rate : 0.0),
                fmt::format("1 s to {:.1f} %", kPercent * kRateTolerance),
                "set a lower frame rate: the camera does not reach the one that it counts"});
}

void checkIntervals(const StreamStatistics& statistics, FindingList& findings) {
  if (statistics.rate <= 0.0) return;
  constexpr double kMaxUneven = 0.1, kMaxPeriods = 1.6;
  const double gap = statistics.largest_gap * statistics.rate;
  findings.add(
      "intervals", okIf(statistics.uneven <= kMaxUneven && gap <= kMaxPeriods, Verdict::look_at),
      {fmt::format("uneven by {:.1f} % of a period, longest {:.0f} ms", kPercent * statistics.uneven,
                   kMilliseconds * statistics.largest_gap),
       "even, none left out", "set a rate that the sensor has; switch slow shutter off; repair the link"});
}

void checkEncoding(const StreamMeasurement& measurement, const StreamStatistics& statistics,
                   FindingList& findings) {
  findings.add("codec", Verdict::ok,
               {*measurement.codec == capture::VideoCodec::h264 ? "H.264" : "H.265", "H.264 or H.265"});
  findings.add("B-frames", okIf(!statistics.has_b_frames, Verdict::look_at),
               {statistics.has_b_frames ? "yes: they add latency" : "none", "none",
                "switch B-frames and smart codec off in the camera"});
  constexpr double kMaxKeyInterval = 1.5;  // s
  const double key_interval = statistics.key_interval.value_or(statistics.seconds);
  const bool is_long = key_interval > kMaxKeyInterval;
  const std::string interval = fmt::format("{:.2f} s", key_interval);
  if (!statistics.key_interval && !is_long) {
    findings.add("key frame interval", Verdict::not_checked,
                 {"more than " + interval, "", "raise --seconds"});
  } else {
    findings.add("key frame interval", okIf(!is_long, Verdict::look_at),
                 {statistics.key_interval ? interval : "more than " + interval, "1 s",
                  "set the I-frame interval to one second, and smart codec off: cartvo camera apply"});
  }
}

void checkBitRate(const StreamMeasurement& measurement, const StreamStatistics& statistics,
                  FindingList& findings) {
  constexpr double kEnough = 4e6;          // bit/s
  constexpr double kEnoughOfPixel = 0.15;  // bit per pixel, for small pictures
  const double pixels = statistics.rate * measurement.size.area();
  const double of_pixel = pixels > 0.0 ? statistics.bit_rate / pixels : 0.0;
  constexpr double kTolerance = 0.5;  // a camera sends less of a scene that does not move
  const bool is_enough = statistics.bit_rate >= kTolerance * kEnough || of_pixel >= kEnoughOfPixel;
  findings.add("bit rate", okIf(is_enough, Verdict::look_at),
               {fmt::format("{:.0f} kbit/s, {:.2f} bit per pixel", statistics.bit_rate / kKilobit, of_pixel),
                fmt::format("about {:.0f} kbit/s or {} bit per pixel", kEnough / kKilobit, kEnoughOfPixel),
                "set a constant bit rate of 4096 kbit/s or more: cartvo camera apply bit-rate"});
}

void checkLosses(const StreamMeasurement& measurement, const StreamStatistics& statistics,
                 FindingList& findings) {
  findings.add(
      "losses", okIf(statistics.losses == 0, Verdict::look_at),
      {fmt::format("{} of {} pictures with missing data", statistics.losses, measurement.pictures.size()),
       "none", "cameras.transport: tcp; repair cable, switch or radio link"});
  constexpr double kMaxJitter = 0.03;  // s
  findings.add(
      "arrivals", okIf(statistics.arrival_jitter <= kMaxJitter, Verdict::look_at),
      {fmt::format("95 % within {:.1f} ms of the fastest", kMilliseconds * statistics.arrival_jitter),
       fmt::format("within {:.0f} ms", kMilliseconds * kMaxJitter),
       "use cable instead of radio; keep other traffic off this network"});
}

void checkReports(const StreamStatistics& statistics, FindingList& findings) {
  if (!statistics.latency) {
    findings.add("sender reports", Verdict::look_at,
                 {fmt::format("none in {:.0f} s", statistics.seconds), "one every few seconds",
                  "connect to the camera itself, without a re-streamer; raise --seconds; else leave "
                  "cameras.clock: auto"});
    return;
  }
  constexpr double kMaxSpread = 0.01;  // s
  findings.add("sender reports", okIf(statistics.report_spread <= kMaxSpread, Verdict::look_at),
               {fmt::format("they agree within {:.1f} ms", kMilliseconds * statistics.report_spread),
                fmt::format("within {:.0f} ms", kMilliseconds * kMaxSpread),
                "the camera's clock is being set: give it a time server that it reaches, with the shortest "
                "interval, and wait"});
  const bool is_plausible = *statistics.latency >= kFastestLatency && *statistics.latency <= kSlowestLatency;
  findings.add(
      "clock", okIf(is_plausible, Verdict::look_at),
      {fmt::format("pictures arrive {:+.1f} ms after their exposure, by both clocks",
                   kMilliseconds * *statistics.latency),
       fmt::format("{:.0f} to {:.0f} ms", kMilliseconds * kFastestLatency, kMilliseconds * kSlowestLatency),
       "the clocks of camera and computer disagree: set the camera to NTP with this computer as its "
       "server (/usr/share/doc/cartvo/network.md)"});
}

void checkDecoding(const StreamMeasurement& measurement, const StreamStatistics& statistics,
                   FindingList& findings) {
  if (measurement.decode_times.empty() || statistics.rate <= 0.0) return;
  constexpr double kMaxShare = 0.5;  // of the frame period
  const double seconds = medianOf(measurement.decode_times);
  findings.add("decoding", okIf(seconds * statistics.rate <= kMaxShare, Verdict::look_at),
               {fmt::format("{:.1f} ms a picture (median)", kMilliseconds * seconds),
                fmt::format("at most half of the frame period, {:.0f} ms",
                            kMilliseconds * kMaxShare / statistics.rate),
                "stop other programs; set a smaller picture and calibrate again; H.264 instead of H.265"});
}

}  // namespace

bool checkStream(const StreamMeasurement& measurement, const StreamNeeds& needs, FindingList& findings) {
  if (measurement.is_refused) {
    findings.add("login", Verdict::broken,
                 {measurement.problem, "the camera accepts user and password",
                  "correct username and the password file; wait until a lock ends, or switch the camera off "
                  "and on"});
    return false;
  }
  if (measurement.pictures.empty() || measurement.size.empty()) {
    findings.add(
        "stream", Verdict::broken,
        {measurement.problem.empty() ? "no picture" : measurement.problem, "pictures",
         "if the camera answers, correct what its answer names, such as the path in its url; if it does not, "
         "see that it has power and its cable"});
    return false;
  }
  const StreamStatistics statistics = statisticsOf(measurement);
  findings.add(
      "stream", okIf(measurement.problem.empty(), Verdict::look_at),
      {fmt::format("{} pictures in {:.1f} s", measurement.pictures.size(), statistics.seconds) +
           (measurement.problem.empty() ? "" : "; " + measurement.problem),
       "pictures without a break", "as the text says; /usr/share/doc/cartvo/troubleshooting.md has more"});
  checkSize(measurement, needs, findings);
  checkRate(statistics, needs, findings);
  checkIntervals(statistics, findings);
  if (measurement.codec) {
    checkEncoding(measurement, statistics, findings);
    checkBitRate(measurement, statistics, findings);
    checkLosses(measurement, statistics, findings);
    checkReports(statistics, findings);
  }
  checkDecoding(measurement, statistics, findings);
  return true;
}

void compareStreams(const std::array<StreamMeasurement, 2>& streams, FindingList& findings) {
  const StreamStatistics left = statisticsOf(streams[0]), right = statisticsOf(streams[1]);
  if (left.rate <= 0.0 || right.rate <= 0.0) return;
  const bool by_host = left.host_rate > 0.0 && right.host_rate > 0.0;
  const double left_rate = by_host ? left.host_rate : left.rate;
  const double right_rate = by_host ? right.host_rate : right.rate;
  findings.add(
      "frame rates",
      okIf(isRate(left_rate, std::hypot(left.host_rate_stddev, right.host_rate_stddev), right_rate),
           Verdict::look_at),
      {fmt::format("left {:.3f} Hz, right {:.3f} Hz", left_rate, right_rate),
       fmt::format("equal to {:.1f} %", kPercent * kRateTolerance), "set both cameras to one frame rate"});
  if (!left.latency || !right.latency) return;
  constexpr double kMaxDifference = 0.01;  // s
  const double difference = *right.latency - *left.latency;
  findings.add(
      "clocks", okIf(std::abs(difference) <= kMaxDifference, Verdict::look_at),
      {fmt::format("the right camera's pictures arrive {:+.1f} ms later after their exposure than the "
                   "left one's, by the cameras' clocks",
                   kMilliseconds * difference),
       fmt::format("within {:.0f} ms", kMilliseconds * kMaxDifference),
       "give both cameras one time server and the same settings; cameras of two models may differ"});
}

}  // namespace cartvo::doctor
