#pragma once

#include <cstdint>
#include <deque>
#include <optional>

namespace cartvo::capture {

/// Clock model of a camera's RTP clock against the camera's own wall clock, from RTCP sender reports. A
/// report is a noisy sample, because cameras put the time of sending into it. Offset and skew are fitted
/// robustly over the latest ten minutes; a step of the wall clock restarts the fit. Reads no clock;
/// deterministic.
class SenderReportClockModel {
 public:
  /// `default_scatter_ns`: standard deviation of one report while there are too few to estimate it, unless
  /// these scatter by more.
  explicit SenderReportClockModel(double default_scatter_ns) : default_scatter_ns_(default_scatter_ns) {}

  /// Adds a report: the picture with RTP time `rtp_ns` was exposed at `instant_ns` by the camera's wall
  /// clock. `expected_skew`: skew of the RTP clock by another source; prior with a standard deviation of 20
  /// ppm, because the wall clock follows true time about as well.
  void add(std::int64_t rtp_ns, std::int64_t instant_ns, double expected_skew);

  bool hasData() const { return !samples_.empty(); }

  /// Camera's wall clock, ns since the Unix epoch. Requires hasData().
  std::int64_t at(std::int64_t rtp_ns) const;

  /// Standard deviation of `at`, ns, from the scatter of the reports. Excludes the error of the wall clock.
  double stddevNs(std::int64_t rtp_ns) const;

  /// Standard deviation of one report, ns.
  double scatterNs() const { return scatter_ns_; }

  /// Number of times the camera's wall clock was set.
  std::uint64_t steps() const { return steps_; }

  /// Number of reports, and of those that were left out because they contradict the others.
  std::uint64_t reports() const { return reports_; }
  std::uint64_t leftOut() const { return left_out_; }

 private:
  struct Sample {
    double time = 0.0;    ///< RTP, s from the first report
    double offset = 0.0;  ///< instant minus RTP time, ns, relative to the first report
  };

  double secondsSince(std::int64_t rtp_ns) const;
  double offsetAt(double time) const { return intercept_ + slope_ * (time - centre_); }
  double variance(double time) const;
  bool isOutlier(const Sample& sample);
  void leaveOutliersOut();
  void fit(double expected_slope);
  void solveReweighted(double expected_slope);
  double estimateScatter() const;

  double default_scatter_ns_;
  std::int64_t origin_rtp_ns_ = 0;
  std::int64_t origin_instant_ns_ = 0;
  std::deque<Sample> samples_;
  std::deque<Sample> outliers_;  ///< the latest samples if they are outliers, all on one side of the model
  double centre_ = 0.0;          ///< s; time of the latest report
  double intercept_ = 0.0;       ///< ns, at the centre
  double slope_ = 0.0;           ///< ns/s
  double scatter_ns_ = 0.0;
  double variances_[3] = {};  ///< of the intercept, covariance of both, of the slope
  std::uint64_t steps_ = 0;
  std::uint64_t reports_ = 0;
  std::uint64_t left_out_ = 0;
};

/// Extracts RTCP sender reports (RFC 3550, 6.4.1) from the instant of each picture by the last report, which
/// is what recordings hold. Reads no clock; deterministic.
///
/// Corrects a fault of FFmpeg 5.1, by which recordings made before RtspSession's own client were received: it
/// relates a packet to the last report with a 32-bit difference that it
/// does not wrap. After a wrap of the RTP clock (every 13.3 h) its instants are 2^32/90000 s = 47,721.9 s off
/// until the next report. FFmpeg unwraps the RTP time stamps themselves correctly, so a jump of that size in
/// the difference of the two is undone.
class SenderReportExtractor {
 public:
  /// `rtp_us`: the picture's RTP time, unwrapped; `reference_us`: its instant by the last report, us since
  /// the Unix epoch; `expected_us`: its approximate instant. Returns the corrected instant, us since the Unix
  /// epoch, if there was a new report since the last call, or the last one has been valid for 10 s.
  std::optional<std::int64_t> extract(std::int64_t rtp_us, std::int64_t reference_us,
                                      std::int64_t expected_us);

 private:
  std::int64_t missingWraps(std::int64_t difference_us);

  std::optional<std::int64_t> last_offset_us_;  ///< instant minus RTP time by the last report
  std::int64_t last_rtp_us_ = 0;
  int corrected_reports_ = 0;  ///< consecutive reports that agree only after a wrap is undone
};

}  // namespace cartvo::capture
