#include "capture/report_line.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "capture/median.hpp"

namespace cartvo {
namespace {

constexpr double kWindow = 600.0;  // s
constexpr std::size_t kMostSamples = 256;
constexpr double kSkewDeviation = 20e3;  // ns/s: a camera's clock against the host's
constexpr std::size_t kSamplesForScatter = 4;
constexpr double kLeastScatter_ns = 12e3;  // a tick of RTP time
constexpr double kLeastStep_ns = 500e3;    // less than that is slewing
constexpr double kStrayDeviations = 4.0;
constexpr std::size_t kStraysOfAStep = 3;
constexpr double kHuber = 1.5;  // standard deviations from which on a sample loses weight
constexpr int kIterations = 4;

}  // namespace

double ReportLine::secondsSince(std::int64_t rtp_ns) const {
  return static_cast<double>(rtp_ns - origin_rtp_ns_) * 1e-9;
}

std::int64_t ReportLine::at(std::int64_t rtp_ns) const {
  return origin_instant_ns_ + (rtp_ns - origin_rtp_ns_) + std::llround(lineAt(secondsSince(rtp_ns)));
}

double ReportLine::variance(double time) const {
  const double ahead = time - centre_;
  return variances_[0] + 2.0 * ahead * variances_[1] + ahead * ahead * variances_[2];
}

double ReportLine::deviationNs(std::int64_t rtp_ns) const {
  return std::sqrt(std::max(variance(secondsSince(rtp_ns)), 0.0));
}

void ReportLine::add(std::int64_t rtp_ns, std::int64_t instant_ns, double expected_skew) {
  if (samples_.empty()) {
    origin_rtp_ns_ = rtp_ns;
    origin_instant_ns_ = instant_ns;
  }
  const std::int64_t since = rtp_ns - origin_rtp_ns_;
  const Sample sample{static_cast<double>(since) * 1e-9,
                      static_cast<double>(instant_ns - origin_instant_ns_ - since)};
  if (samples_.size() >= 2 && isStep(sample)) {
    strays_.push_back(sample);
    if (strays_.size() < kStraysOfAStep) return;
    samples_.clear();
    samples_.swap(strays_);
    ++steps_;
  } else {
    strays_.clear();
    samples_.push_back(sample);
  }
  while (samples_.size() > kMostSamples || samples_.front().time < sample.time - kWindow)
    samples_.pop_front();
  fit(expected_skew * 1e9);
}

/// Whether the sample is too far off for noise, on the side of the strays before it.
bool ReportLine::isStep(const Sample& sample) {
  const double miss = sample.offset - lineAt(sample.time);
  const double usual = std::sqrt(scatter_ns_ * scatter_ns_ + variance(sample.time));
  if (std::abs(miss) < std::max(kStrayDeviations * usual, kLeastStep_ns)) return false;
  if (!strays_.empty() && (strays_.back().offset - lineAt(strays_.back().time) > 0.0) != (miss > 0.0))
    strays_.clear();
  return true;
}

/// Huber's M-estimate by reweighting, with what is known of the slope beforehand.
void ReportLine::fit(double expected_slope) {
  centre_ = samples_.back().time;
  std::vector<double> offsets;
  for (const Sample& s : samples_)
    offsets.push_back(s.offset - expected_slope * (s.time - centre_));
  intercept_ = medianOfDelays(std::move(offsets));
  slope_ = expected_slope;
  scatter_ns_ = scatter();
  for (int i = 0; i < kIterations; ++i) {
    weigh(expected_slope);
    scatter_ns_ = scatter();
  }
}

/// One weighted least-squares step: (sum w J^T J / scatter^2 + prior) x = sum w J^T y / scatter^2 + prior.
void ReportLine::weigh(double expected_slope) {
  const double information = 1.0 / (scatter_ns_ * scatter_ns_);
  double a = 0.0;
  double b = 0.0;
  double c = 1.0 / (kSkewDeviation * kSkewDeviation);
  double right_a = 0.0;
  double right_c = c * expected_slope;
  for (const Sample& s : samples_) {
    const double residual = std::abs(s.offset - lineAt(s.time));
    const double weight = information * std::min(1.0, kHuber * scatter_ns_ / std::max(residual, 1.0));
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

/// By the median of the residuals. Few samples tell little; but two that agree closely hardly do so by
/// chance.
double ReportLine::scatter() const {
  if (samples_.size() < 2) return usual_scatter_ns_;
  std::vector<double> sizes;
  double sum = 0.0;
  for (const Sample& s : samples_) {
    const double residual = s.offset - lineAt(s.time);
    sum += residual * residual;
    sizes.push_back(std::abs(residual));
  }
  const auto count = static_cast<double>(samples_.size());
  if (samples_.size() < kSamplesForScatter) {
    const double student = samples_.size() == 2 ? 6.4 : 2.2;  // of t over that of the normal, at 95 %
    return std::clamp(student * std::sqrt(sum / (count - 1.0)), kLeastScatter_ns, usual_scatter_ns_);
  }
  return std::max(1.4826 * (1.0 + 4.0 / count) * medianOfDelays(std::move(sizes)), kLeastScatter_ns);
}

}  // namespace cartvo
