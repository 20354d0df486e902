// Processes a few pairs to see whether the computer is fast enough.
#include "tools/doctor/odometry_checks.hpp"

#include <algorithm>
#include <exception>
#include <string>

#include <fmt/format.h>
#include <opencv2/core/utility.hpp>

#include "calib/rectification/rectification_tables.hpp"
#include "calib/rectification/rectifier.hpp"
#include "common/statistics.hpp"
#include "daemon/publish/message_names.hpp"
#include "daemon/publish/odometry_publisher.hpp"
#include "pipeline/pair_processor.hpp"

namespace cartvo::doctor {
namespace {

constexpr std::size_t kFewestPairs = 5;
constexpr double kMilliseconds = 1e3;

/// Results of processing some pairs.
struct Processed {
  std::vector<double> times;  ///< s
  std::size_t valid = 0;
  odometry_t last{};
  std::string bound_exceeded;  ///< by the last one, LimitedBound::text(); empty: none
};

Processed process(const std::vector<capture::FramePair>& pairs, const OdometrySetup& setup,
                  const WorkObserver::Progress& progress, const std::atomic<bool>& interrupted) {
  cv::setNumThreads(setup.threads);
  const calib::RectificationSettings& rectification = setup.rig.rectification;
  pipeline::PairProcessor processor(setup.rig,
                                    {setup.rig, rectification, calib::buildTables(setup.rig, rectification)},
                                    {setup.settings, setup.absent_readout, setup.alert_limits});
  Processed processed;
  for (const capture::FramePair& pair : pairs) {
    if (interrupted) break;
    const pipeline::PairResult result = processor.process(pair);
    processed.times.push_back(result.times.total);
    processed.last = daemon::odometryMessage(result);
    processed.bound_exceeded = result.exceedsAlertLimit() ? result.worst->text() : "";
    if (processed.last.status == odometry_t::VALID) ++processed.valid;
    progress(static_cast<int>(processed.times.size()), static_cast<int>(pairs.size()));
  }
  return processed;
}

/// Median interval of the left exposures, s.
double periodOf(const std::vector<capture::FramePair>& pairs) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < pairs.size(); ++i)
    intervals.push_back(1e-9 *
                        static_cast<double>(pairs[i].left.exposure_ns - pairs[i - 1].left.exposure_ns));
  return medianOf(intervals);
}

void addSpeed(const Processed& processed, double period, FindingList& findings) {
  constexpr double kMost = 0.95, kMaxShare = 0.7;
  const double seconds = quantile(processed.times, kMost);
  const Verdict otherwise = seconds > 2.0 * period ? Verdict::broken : Verdict::look_at;
  findings.add("processing time", okIf(seconds <= kMaxShare * period, otherwise),
               {fmt::format("{:.1f} ms a pair (95 %), {:.0f} % of the frame period of {:.1f} ms",
                            kMilliseconds * seconds, 100.0 * seconds / period, kMilliseconds * period),
                fmt::format("at most {:.0f} %", 100.0 * kMaxShare),
                "stop other programs, raise odometry.threads up to the number of processors, or lower "
                "odometry.features"});
}

void addValidity(const Processed& processed, FindingList& findings) {
  const bool is_valid = processed.last.status == odometry_t::VALID;
  // A drive may end in a bad place; without any valid pair cartvod does not work here.
  const Verdict otherwise = processed.valid == 0 ? Verdict::broken : Verdict::look_at;
  findings.add("odometry", okIf(is_valid, otherwise),
               {fmt::format("{} of {} pairs valid", processed.valid, processed.times.size()) +
                    (is_valid ? "" : "; the last one not: " + daemon::reasonNames(processed.last.reasons)) +
                    (processed.bound_exceeded.empty() ? "" : ": " + processed.bound_exceeded),
                "valid within a second",
                "see to what is said of the pictures first; else see "
                "/usr/share/doc/cartvo/troubleshooting.md for this reason"});
}

}  // namespace

void checkProcessing(const std::vector<capture::FramePair>& pairs, const OdometrySetup& setup,
                     const WorkObserver::Progress& progress, const std::atomic<bool>& interrupted,
                     FindingList& findings) {
  if (pairs.size() < kFewestPairs) {
    findings.add("processing time", Verdict::not_checked,
                 {fmt::format("{} pairs of pictures", pairs.size()), "", "see the streams' lines"});
    return;
  }
  try {
    const Processed processed = process(pairs, setup, progress, interrupted);
    if (processed.times.size() < kFewestPairs) return;
    addSpeed(processed, periodOf(pairs), findings);
    addValidity(processed, findings);
  } catch (const std::exception& error) {
    findings.add("odometry", Verdict::broken,
                 {error.what(), "pairs can be processed", "use the rig file of these cameras"});
  }
}

}  // namespace cartvo::doctor
