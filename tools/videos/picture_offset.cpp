// Estimates the time offset of two videos by correlating and then fitting their image motions.
#include "tools/videos/picture_offset.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include <opencv2/core.hpp>

#include "common/statistics.hpp"

namespace cartvo {
namespace {

constexpr double kMinOverlap = 5.0;  // s
constexpr double kMinOverlapFraction = 1.0 / 3.0;
constexpr double kMinAgreement = 0.5;
constexpr double kDistinctSeparation = 3.0;  // s; shifts further apart are different solutions
constexpr double kMinAmbiguityMargin = 0.1;  // lead of the best correlation over other shifts

constexpr std::size_t kMinPictures = 10;
constexpr double kSegmentLength = 20.0;    // s
constexpr double kMaxSkew = 200e-6;        // relative rate of two crystal clocks
constexpr double kMinSkewSpan = 60.0;      // s; the skew is not estimated from shorter videos
constexpr double kTrialsPerPeriod = 20.0;  // per frame period
constexpr double kMinStddev = 1e-3;        // s, for parallax, which moves the two images differently

[[noreturn]] void fail(const std::string& reason) {
  throw std::runtime_error("the time offset of the two videos cannot be found from their pictures: " +
                           reason + "; give --offset-ms");
}

void requireEnoughPictures(const char* side, const ImageMotion& motion) {
  const std::size_t count = motion.times.size();
  if (count < kMinPictures)
    fail(std::string("the ") + side + " video has " + std::to_string(count) +
         " pictures; expected at least " + std::to_string(kMinPictures));
}

double medianStep(const std::vector<double>& times) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i)
    steps.push_back(times[i] - times[i - 1]);
  return medianOf(std::move(steps));
}

/// Interpolates an image motion between its pictures by a Catmull-Rom cubic.
class MotionInterpolator {
 public:
  explicit MotionInterpolator(const ImageMotion& motion) : motion_(motion) {}

  bool covers(double time) const { return time >= motion_.times.front() && time <= motion_.times.back(); }

  cv::Point2d at(double time) const {
    const std::vector<double>& times = motion_.times;
    const auto after = std::upper_bound(times.begin() + 1, times.end() - 1, time);
    const auto i = static_cast<std::size_t>(after - times.begin()) - 1;
    const double step = times[i + 1] - times[i];
    const double u = (time - times[i]) / step;
    const cv::Point2d begin = slope(i) * step;
    const cv::Point2d end = slope(i + 1) * step;
    const cv::Point2d& a = motion_.positions[i];
    const cv::Point2d& b = motion_.positions[i + 1];
    return (1.0 + 2.0 * u) * (1.0 - u) * (1.0 - u) * a + u * (1.0 - u) * (1.0 - u) * begin +
           u * u * (3.0 - 2.0 * u) * b - u * u * (1.0 - u) * end;
  }

 private:
  cv::Point2d slope(std::size_t i) const {
    const std::size_t before = i == 0 ? 0 : i - 1;
    const std::size_t after = std::min(i + 1, motion_.times.size() - 1);
    return (motion_.positions[after] - motion_.positions[before]) /
           (motion_.times[after] - motion_.times[before]);
  }

  const ImageMotion& motion_;
};

/// Image velocity on a uniform time grid, each axis without its mean.
struct VelocitySignal {
  double begin = 0.0;  ///< s
  std::array<std::vector<double>, 2> velocity;
  std::size_t size() const { return velocity[0].size(); }
};

VelocitySignal sampleVelocity(const ImageMotion& motion, double step) {
  const MotionInterpolator path(motion);
  VelocitySignal result;
  result.begin = motion.times.front();
  cv::Point2d last = motion.positions.front();
  for (double time = result.begin + step; time <= motion.times.back(); time += step) {
    const cv::Point2d current = path.at(time);
    result.velocity[0].push_back((current.x - last.x) / step);
    result.velocity[1].push_back((current.y - last.y) / step);
    last = current;
  }
  for (std::vector<double>& values : result.velocity) {
    double mean = 0.0;
    for (const double value : values)
      mean += value / static_cast<double>(values.size());
    for (double& value : values)
      value -= mean;
  }
  return result;
}

/// Sums of the squared velocities before each sample.
std::vector<double> cumulativeEnergy(const VelocitySignal& signal) {
  std::vector<double> sums(signal.size() + 1, 0.0);
  for (std::size_t i = 0; i < signal.size(); ++i) {
    const double x = signal.velocity[0][i];
    const double y = signal.velocity[1][i];
    sums[i + 1] = sums[i] + x * x + y * y;
  }
  return sums;
}

/// Cross-correlation, the sum over i of left[i + lag] * right[i] over both axes, for lags from -(right size -
/// 1) to left size - 1.
std::vector<double> crossCorrelate(const VelocitySignal& left, const VelocitySignal& right) {
  const int length = cv::getOptimalDFTSize(static_cast<int>(left.size() + right.size()));
  cv::Mat sum = cv::Mat::zeros(1, length, CV_64F);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    cv::Mat a = cv::Mat::zeros(1, length, CV_64F);
    cv::Mat b = cv::Mat::zeros(1, length, CV_64F);
    std::copy(left.velocity[axis].begin(), left.velocity[axis].end(), a.ptr<double>());
    std::copy(right.velocity[axis].begin(), right.velocity[axis].end(), b.ptr<double>());
    cv::dft(a, a);
    cv::dft(b, b);
    cv::mulSpectrums(a, b, a, 0, true);
    cv::idft(a, a, cv::DFT_SCALE);
    sum += a;
  }
  const auto right_size = static_cast<int>(right.size());
  std::vector<double> values;
  for (int lag = 1 - right_size; lag < static_cast<int>(left.size()); ++lag)
    values.push_back(sum.at<double>(0, (lag + length) % length));
  return values;
}

/// An offset on the coarse grid and the normalised correlation at it.
struct OffsetCandidate {
  double offset = 0.0;     ///< s
  double agreement = 0.0;  ///< -1..1
};

/// Normalised correlation at all shifts with enough overlap.
std::vector<OffsetCandidate> correlateAllShifts(const ImageMotion& left_motion,
                                                const ImageMotion& right_motion, double step) {
  const VelocitySignal left = sampleVelocity(left_motion, step);
  const VelocitySignal right = sampleVelocity(right_motion, step);
  const std::vector<double> left_energy = cumulativeEnergy(left);
  const std::vector<double> right_energy = cumulativeEnergy(right);
  const std::vector<double> products = crossCorrelate(left, right);
  const auto shorter = static_cast<double>(std::min(left.size(), right.size()));
  const double min_overlap = std::max(kMinOverlap / step, kMinOverlapFraction * shorter);
  const auto left_size = static_cast<std::ptrdiff_t>(left.size());
  const auto right_size = static_cast<std::ptrdiff_t>(right.size());
  std::vector<OffsetCandidate> result;
  for (std::ptrdiff_t lag = 1 - right_size; lag < left_size; ++lag) {
    const std::ptrdiff_t begin = std::max<std::ptrdiff_t>(lag, 0);  // in the left signal
    const std::ptrdiff_t end = std::min(left_size, lag + right_size);
    if (static_cast<double>(end - begin) < min_overlap) continue;
    const auto energy = [](const std::vector<double>& sums, std::ptrdiff_t from, std::ptrdiff_t to) {
      return sums[static_cast<std::size_t>(to)] - sums[static_cast<std::size_t>(from)];
    };
    const double scale =
        std::sqrt(energy(left_energy, begin, end) * energy(right_energy, begin - lag, end - lag));
    const double product = products[static_cast<std::size_t>(lag + right_size - 1)];
    result.push_back(
        {left.begin - right.begin + static_cast<double>(lag) * step, scale > 0.0 ? product / scale : 0.0});
  }
  return result;
}

OffsetCandidate findCoarseOffset(const ImageMotion& left, const ImageMotion& right, double step) {
  const std::vector<OffsetCandidate> all = correlateAllShifts(left, right, step);
  if (all.empty()) fail("they are too short; expected at least 5 s of driving");
  const auto less = [](const OffsetCandidate& a, const OffsetCandidate& b) {
    return a.agreement < b.agreement;
  };
  const OffsetCandidate best = *std::max_element(all.begin(), all.end(), less);
  double next = 0.0;
  for (const OffsetCandidate& other : all) {
    if (std::abs(other.offset - best.offset) > kDistinctSeparation) next = std::max(next, other.agreement);
  }
  char text[160];
  if (best.agreement < kMinAgreement) {
    std::snprintf(text, sizeof text,
                  "the correlation of the two image motions is only %.2f; expected at least %.1f",
                  best.agreement, kMinAgreement);
    fail(text);
  }
  if (best.agreement - next < kMinAmbiguityMargin) {
    std::snprintf(text, sizeof text,
                  "shifts more than %.0f s apart agree as well (correlations %.2f and %.2f)",
                  kDistinctSeparation, best.agreement, next);
    fail(text);
  }
  return best;
}

/// Offset estimated from one segment of the right video.
struct SegmentOffset {
  double time = 0.0;    ///< s, middle of the segment in the right file's time
  double offset = 0.0;  ///< s
  double stddev = 0.0;  ///< s
};

/// A segment of the right image motion, to be fitted by the left image motion.
class RightSegment {
 public:
  RightSegment(const MotionInterpolator& left, const ImageMotion& right, std::size_t first, std::size_t last)
      : left_(left), right_(right), first_(first), last_(last) {}

  /// Mean squared residual of the fit at `offset`; none if the left motion does not cover the segment.
  std::optional<double> residualVariance(double offset) const {
    if (!left_.covers(right_.times[first_] + offset) || !left_.covers(right_.times[last_] + offset))
      return std::nullopt;
    std::array<double, 2> left_square{}, right_square{}, product{};
    cv::Point2d last = left_.at(right_.times[first_] + offset);
    for (std::size_t i = first_ + 1; i <= last_; ++i) {
      const cv::Point2d current = left_.at(right_.times[i] + offset);
      const cv::Point2d l = current - last;
      const cv::Point2d r = right_.positions[i] - right_.positions[i - 1];
      left_square[0] += l.x * l.x;
      left_square[1] += l.y * l.y;
      right_square[0] += r.x * r.x;
      right_square[1] += r.y * r.y;
      product[0] += l.x * r.x;
      product[1] += l.y * r.y;
      last = current;
    }
    // The lenses may differ in focal length: each axis has its own scale factor.
    double sum = 0.0;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const double modelled =
          left_square[axis] > 0.0 ? product[axis] * product[axis] / left_square[axis] : 0.0;
      sum += right_square[axis] - modelled;
    }
    return sum / static_cast<double>(last_ - first_);
  }

  double middle() const { return 0.5 * (right_.times[first_] + right_.times[last_]); }
  double observationCount() const { return static_cast<double>(2 * (last_ - first_)); }

 private:
  const MotionInterpolator& left_;
  const ImageMotion& right_;
  std::size_t first_, last_;
};

/// The offset of least residual within `reach` of `around`: trials at each `step`, then a parabola.
std::optional<SegmentOffset> refineOffset(const RightSegment& segment, double around, double reach,
                                          double step) {
  std::vector<double> trials, costs;
  for (double offset = around - reach; offset <= around + reach; offset += step) {
    const std::optional<double> cost = segment.residualVariance(offset);
    if (!cost) return std::nullopt;
    trials.push_back(offset);
    costs.push_back(*cost);
  }
  // A parabola through points a frame period apart would be too coarse, through adjacent trials too noisy.
  constexpr std::size_t kHalfWidth = 5;
  const auto best = static_cast<std::size_t>(std::min_element(costs.begin(), costs.end()) - costs.begin());
  if (best < kHalfWidth || best + kHalfWidth >= costs.size()) return std::nullopt;
  const double half_width = static_cast<double>(kHalfWidth) * step;
  const double before = costs[best - kHalfWidth];
  const double after = costs[best + kHalfWidth];
  const double curvature = (before - 2.0 * costs[best] + after) / (half_width * half_width);
  if (curvature <= 0.0) return std::nullopt;
  const double shift = std::clamp((before - after) / (2.0 * half_width * curvature), -half_width, half_width);
  const double variance = 2.0 * costs[best] / (curvature * segment.observationCount());
  return SegmentOffset{segment.middle(), trials[best] + shift, std::sqrt(variance) + 1e-6};
}

std::vector<SegmentOffset> findSegmentOffsets(const ImageMotion& left, const ImageMotion& right,
                                              double around) {
  const MotionInterpolator path(left);
  const double period = medianStep(right.times);
  const double duration = right.times.back() - right.times.front();
  const double reach = 2.0 * period + 0.5 * kMaxSkew * duration;
  // Uses only times at which the left motion covers all trial offsets.
  const auto is_covered = [&](double time) {
    return path.covers(time + around - reach) && path.covers(time + around + reach);
  };
  std::vector<SegmentOffset> segments;
  const std::size_t pictures = right.times.size();
  std::size_t first = 0;
  while (first < pictures && !is_covered(right.times[first]))
    ++first;
  for (std::size_t i = first + 1; i < pictures && is_covered(right.times[i]); ++i) {
    const bool is_last = i + 1 == pictures || !is_covered(right.times[i + 1]);
    const double length = right.times[i] - right.times[first];
    if (length < kSegmentLength && !is_last) continue;
    if (length >= kMinOverlap) {
      if (const auto found =
              refineOffset(RightSegment(path, right, first, i), around, reach, period / kTrialsPerPeriod))
        segments.push_back(*found);
    }
    first = i;
  }
  return segments;
}

double weightOf(const SegmentOffset& segment) {
  return 1.0 / (segment.stddev * segment.stddev);
}

/// Removes segments further from the weighted median than their standard deviations and a clock skew allow.
void rejectOutliers(std::vector<SegmentOffset>& segments) {
  std::sort(segments.begin(), segments.end(),
            [](const SegmentOffset& a, const SegmentOffset& b) { return a.offset < b.offset; });
  double total = 0.0;
  for (const SegmentOffset& segment : segments)
    total += weightOf(segment);
  double below = 0.0;
  SegmentOffset median = segments.front();
  for (const SegmentOffset& segment : segments) {
    median = segment;
    below += weightOf(segment);
    if (below >= 0.5 * total) break;
  }
  std::erase_if(segments, [&](const SegmentOffset& segment) {
    const double bound = 10e-3 + 4.0 * segment.stddev + kMaxSkew * std::abs(segment.time - median.time);
    return std::abs(segment.offset - median.offset) > bound;
  });
}

}  // namespace

PictureOffset findPictureOffset(const ImageMotion& left, const ImageMotion& right) {
  requireEnoughPictures("left", left);
  requireEnoughPictures("right", right);
  const double step =
      std::clamp(0.5 * std::min(medianStep(left.times), medianStep(right.times)), 5e-3, 50e-3);
  const OffsetCandidate coarse = findCoarseOffset(left, right, step);
  std::vector<SegmentOffset> segments = findSegmentOffsets(left, right, coarse.offset);
  if (segments.empty()) fail("no part of them shows enough motion");
  rejectOutliers(segments);

  // Weighted linear fit over the segments: value at their centre, and slope.
  double weight = 0.0, centre = 0.0, mean = 0.0, spread = 0.0, product = 0.0;
  for (const SegmentOffset& segment : segments)
    weight += weightOf(segment);
  for (const SegmentOffset& segment : segments) {
    centre += weightOf(segment) * segment.time / weight;
    mean += weightOf(segment) * segment.offset / weight;
  }
  double begin = segments.front().time, end = begin;
  for (const SegmentOffset& segment : segments) {
    spread += weightOf(segment) * (segment.time - centre) * (segment.time - centre);
    product += weightOf(segment) * (segment.time - centre) * (segment.offset - mean);
    begin = std::min(begin, segment.time);
    end = std::max(end, segment.time);
  }
  PictureOffset found;
  const bool estimates_skew = segments.size() > 3 && end - begin >= kMinSkewSpan;
  if (estimates_skew) found.skew = std::clamp(product / spread, -kMaxSkew, kMaxSkew);
  const double skew = found.skew.value_or(0.0);
  found.offset = mean - skew * centre;
  found.agreement = coarse.agreement;

  double chi_square = 0.0;
  for (const SegmentOffset& segment : segments) {
    const double residual = segment.offset - mean - skew * (segment.time - centre);
    chi_square += weightOf(segment) * residual * residual;
  }
  const double freedom = static_cast<double>(segments.size()) - (estimates_skew ? 2.0 : 1.0);
  const double inflation = freedom > 0.0 ? std::max(chi_square / freedom, 1.0) : 1.0;
  const double mean_stddev = std::sqrt(inflation / weight);
  const double skew_stddev = estimates_skew ? std::sqrt(inflation / spread) * 0.5 * (end - begin) : 0.0;
  found.stddev = std::hypot(std::hypot(mean_stddev, skew_stddev), kMinStddev);
  return found;
}

}  // namespace cartvo
