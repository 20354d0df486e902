#pragma once

#include <cstdint>
#include <deque>

namespace cartvo {

/// What a camera's own clock says of its RTP time: a line through the instants of its sender reports, each a
/// sample with noise, because cameras put the instant of sending into them. Offset and skew are fitted
/// robustly over the latest ten minutes; a clock that was set is followed. Pure.
class ReportLine {
 public:
  /// `usual_scatter_ns`: standard deviation of a report, as long as there are too few to tell.
  explicit ReportLine(double usual_scatter_ns) : usual_scatter_ns_(usual_scatter_ns) {}

  /// By a report the picture with RTP time `rtp_ns` was exposed at `instant_ns`. `expected_skew`: of the RTP
  /// clock, as known otherwise; the camera's clock is taken to keep the host's time to some 20 ppm.
  void add(std::int64_t rtp_ns, std::int64_t instant_ns, double expected_skew);

  bool known() const { return !samples_.empty(); }

  /// Camera's clock, ns since the Unix epoch. Only if known.
  std::int64_t at(std::int64_t rtp_ns) const;

  /// Standard deviation of `at`, ns, by the scatter of the reports; the camera's clock may err beyond it.
  double deviationNs(std::int64_t rtp_ns) const;

  /// Standard deviation of one report, ns.
  double scatterNs() const { return scatter_ns_; }

  /// How often the camera's clock was set.
  std::uint64_t steps() const { return steps_; }

 private:
  struct Sample {
    double time = 0.0;    ///< RTP, s from the first report
    double offset = 0.0;  ///< instant minus RTP time, ns, from the first report's
  };

  double secondsSince(std::int64_t rtp_ns) const;
  double lineAt(double time) const { return intercept_ + slope_ * (time - centre_); }
  double variance(double time) const;
  bool isStep(const Sample& sample);
  void fit(double expected_slope);
  void weigh(double expected_slope);
  double scatter() const;

  double usual_scatter_ns_;
  std::int64_t origin_rtp_ns_ = 0;
  std::int64_t origin_instant_ns_ = 0;
  std::deque<Sample> samples_;
  std::deque<Sample> strays_;  ///< the latest, each too far off to be noise, all on one side
  double centre_ = 0.0;        ///< s; of the latest report
  double intercept_ = 0.0;     ///< ns, at the centre
  double slope_ = 0.0;         ///< ns/s
  double scatter_ns_ = 0.0;
  double variances_[3] = {};  ///< of intercept, of both together, of slope
  std::uint64_t steps_ = 0;
};

}  // namespace cartvo
