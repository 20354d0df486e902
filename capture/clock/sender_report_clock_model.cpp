// Robust affine fit of RTCP sender reports over RTP time, and which reports are used.
#include "capture/clock/sender_report_clock_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>
#include <vector>

#include "common/statistics.hpp"

namespace cartvo::capture {
namespace {

constexpr double kWindow = 600.0;  // s
constexpr std::size_t kMaxSamples = 256;
constexpr double kSkewStddev = 20e3;  // ns/s: a camera's wall clock against the host's
constexpr std::size_t kSamplesForScatter = 4;
constexpr double kMinScatter_ns = 12e3;  // one tick of RTP time
constexpr double kMinStep_ns = 500e3;    // smaller changes are slewing
constexpr double kOutlierGate = 4.0;     // standard deviations
constexpr std::size_t kOutliersOfAStep = 3;
constexpr double kHuberThreshold = 1.5;  // standard deviations beyond which a sample is down-weighted
constexpr int kIterations = 4;

constexpr std::int64_t kTicksPerSecond = 90000;
constexpr std::int64_t kWrap_us = (std::int64_t{1} << 32) * 1000000 / kTicksPerSecond;

/// Tolerance for a difference of one wrap: reports are off by up to hundreds of milliseconds, and clocks are
/// set between two reports.
constexpr std::int64_t kWrapTolerance_us = 2000000;

/// FFmpeg's error lasts until the report after the wrap. From this many reports in a row on, the difference
/// is the camera's clock and is not corrected.
constexpr int kClockErrorReports = 3;

/// Two reports that agree to the microsecond are indistinguishable; after this time there was another one.
constexpr std::int64_t kMaxReportInterval_us = 10'000'000;

}  // namespace

double SenderReportClockModel::secondsSince(std::int64_t rtp_ns) const {
  return static_cast<double>(rtp_ns - origin_rtp_ns_) * 1e-9;
}

std::int64_t SenderReportClockModel::at(std::int64_t rtp_ns) const {
  return origin_instant_ns_ + (rtp_ns - origin_rtp_ns_) + std::llround(offsetAt(secondsSince(rtp_ns)));
}

double SenderReportClockModel::variance(double time) const {
  const double ahead = time - centre_;
  return variances_[0] + 2.0 * ahead * variances_[1] + ahead * ahead * variances_[2];
}

double SenderReportClockModel::stddevNs(std::int64_t rtp_ns) const {
  return std::sqrt(std::max(variance(secondsSince(rtp_ns)), 0.0));
}

void SenderReportClockModel::add(std::int64_t rtp_ns, std::int64_t instant_ns, double expected_skew) {
  if (samples_.empty()) {
    origin_rtp_ns_ = rtp_ns;
    origin_instant_ns_ = instant_ns;
  }
  ++reports_;
  const std::int64_t since = rtp_ns - origin_rtp_ns_;
  const Sample sample{static_cast<double>(since) * 1e-9,
                      static_cast<double>(instant_ns - origin_instant_ns_ - since)};
  if (samples_.size() >= 2 && isOutlier(sample)) {
    outliers_.push_back(sample);
    if (outliers_.size() < kOutliersOfAStep) return;
    samples_.clear();
    samples_.swap(outliers_);
    ++steps_;
  } else {
    leaveOutliersOut();
    samples_.push_back(sample);
  }
  while (samples_.size() > kMaxSamples || samples_.front().time < sample.time - kWindow)
    samples_.pop_front();
  fit(expected_skew * 1e9);
}

/// Whether the sample's residual exceeds the gate. Leaves out the outliers before it if they lie on the other
/// side.
bool SenderReportClockModel::isOutlier(const Sample& sample) {
  const double residual = sample.offset - offsetAt(sample.time);
  const double stddev = std::sqrt(scatter_ns_ * scatter_ns_ + variance(sample.time));
  if (std::abs(residual) < std::max(kOutlierGate * stddev, kMinStep_ns)) return false;
  if (!outliers_.empty() &&
      (outliers_.back().offset - offsetAt(outliers_.back().time) > 0.0) != (residual > 0.0))
    leaveOutliersOut();
  return true;
}

void SenderReportClockModel::leaveOutliersOut() {
  left_out_ += outliers_.size();
  outliers_.clear();
}

/// Huber's M-estimate by iterative reweighting, with a prior on the slope.
void SenderReportClockModel::fit(double expected_slope) {
  centre_ = samples_.back().time;
  std::vector<double> offsets;
  for (const Sample& s : samples_)
    offsets.push_back(s.offset - expected_slope * (s.time - centre_));
  intercept_ = medianOf(std::move(offsets));
  slope_ = expected_slope;
  scatter_ns_ = estimateScatter();
  for (int i = 0; i < kIterations; ++i) {
    solveReweighted(expected_slope);
    scatter_ns_ = estimateScatter();
  }
}

/// One weighted least-squares step: (sum w J^T J / scatter^2 + prior) x = sum w J^T y / scatter^2 + prior.
void SenderReportClockModel::solveReweighted(double expected_slope) {
  const double information = 1.0 / (scatter_ns_ * scatter_ns_);
  double a = 0.0;
  double b = 0.0;
  double c = 1.0 / (kSkewStddev * kSkewStddev);
  double right_a = 0.0;
  double right_c = c * expected_slope;
  for (const Sample& s : samples_) {
    const double residual = std::abs(s.offset - offsetAt(s.time));
    const double weight =
        information * std::min(1.0, kHuberThreshold * scatter_ns_ / std::max(residual, 1.0));
    const double time = s.time - centre_;
    a += weight;
    b += weight * time;
    c += weight * time * time;
    right_a += weight * s.offset;
    right_c += weight * time * s.offset;
  }
  const double determinant = a * c - b * b;
  intercept_ = (c * right_a - b * right_c) / determinant;
  slope_ = (a * right_c - b * right_a) / determinant;
  variances_[0] = c / determinant;
  variances_[1] = -b / determinant;
  variances_[2] = a / determinant;
}

/// Standard deviation of one report, from the median of the absolute residuals. With fewer than
/// kSamplesForScatter samples, from their RMS and Student's t: two samples rarely agree closely by chance.
/// Then at most the default, unless the RMS contradicts that.
double SenderReportClockModel::estimateScatter() const {
  if (samples_.size() < 2) return default_scatter_ns_;
  std::vector<double> sizes;
  double sum = 0.0;
  for (const Sample& s : samples_) {
    const double residual = s.offset - offsetAt(s.time);
    sum += residual * residual;
    sizes.push_back(std::abs(residual));
  }
  const auto count = static_cast<double>(samples_.size());
  if (samples_.size() < kSamplesForScatter) {
    const double student =
        samples_.size() == 2 ? 6.4 : 2.2;  // quantile of t over that of the normal, at 95 %
    const double rms = std::sqrt(sum / (count - 1.0));
    return std::clamp(student * rms, kMinScatter_ns, std::max(rms, default_scatter_ns_));
  }
  return std::max(1.4826 * (1.0 + 4.0 / count) * medianOf(std::move(sizes)), kMinScatter_ns);
}

std::optional<std::int64_t> SenderReportExtractor::extract(std::int64_t rtp_us, std::int64_t reference_us,
                                                           std::int64_t expected_us) {
  const std::int64_t offset_us = reference_us - rtp_us;
  // Instants are whole microseconds, so the same report may differ by one.
  const bool same = last_offset_us_ && std::abs(offset_us - *last_offset_us_) <= 1;
  if (same && rtp_us - last_rtp_us_ < kMaxReportInterval_us) return std::nullopt;
  last_offset_us_ = offset_us;
  last_rtp_us_ = rtp_us;
  return reference_us + missingWraps(expected_us - reference_us) * kWrap_us;
}

/// Number of wraps by which the report is off: -1, 0 or 1; 0 from kClockErrorReports reports on.
std::int64_t SenderReportExtractor::missingWraps(std::int64_t difference_us) {
  const std::int64_t wraps = difference_us > 0 ? 1 : -1;
  const bool wrapped = std::abs(difference_us - wraps * kWrap_us) <= kWrapTolerance_us;
  corrected_reports_ = wrapped ? corrected_reports_ + 1 : 0;
  return wrapped && corrected_reports_ < kClockErrorReports ? wraps : 0;
}

}  // namespace cartvo::capture
