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

#include "calib/quantile.hpp"

namespace cartvo {
namespace {

constexpr double kLeastOverlap = 5.0;  // s
constexpr double kLeastOverlapShare = 1.0 / 3.0;
constexpr double kLeastAgreement = 0.5;
constexpr double kApart = 3.0;             // s: two shifts that are further apart are two answers
constexpr double kLeastDistinction = 0.1;  // in agreement, of the best answer from the next

constexpr std::size_t kLeastPictures = 10;
constexpr double kPart = 20.0;            // s
constexpr double kMostSkew = 200e-6;      // of two crystals
constexpr double kTellsSkew = 60.0;       // s
constexpr double kFineSteps = 20.0;       // a period
constexpr double kLeastDeviation = 1e-3;  // s: parallax, which moves both images a little differently

[[noreturn]] void fail(const std::string& reason) {
  throw std::runtime_error("how far apart the two videos are cannot be found from their pictures: " + reason +
                           "; give --offset-ms");
}

void requireEnoughPictures(const char* side, const ImageMotion& motion) {
  const std::size_t count = motion.times.size();
  if (count < kLeastPictures)
    fail(std::string("the ") + side + " one holds fewer than ten pictures: " + std::to_string(count));
}

double medianStep(const std::vector<double>& times) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i)
    steps.push_back(times[i] - times[i - 1]);
  return medianOf(std::move(steps));
}

/// The motion between its pictures, smooth through them (Catmull and Rom's cubic).
class Path {
 public:
  explicit Path(const ImageMotion& motion) : motion_(motion) {}

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

/// Velocities on an even grid, each axis without its mean.
struct Sampled {
  double begin = 0.0;
  std::array<std::vector<double>, 2> velocity;
  std::size_t size() const { return velocity[0].size(); }
};

Sampled sampled(const ImageMotion& motion, double step) {
  const Path path(motion);
  Sampled result;
  result.begin = motion.times.front();
  cv::Point2d last = motion.positions.front();
  for (double time = result.begin + step; time <= motion.times.back(); time += step) {
    const cv::Point2d now = path.at(time);
    result.velocity[0].push_back((now.x - last.x) / step);
    result.velocity[1].push_back((now.y - last.y) / step);
    last = now;
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

std::vector<double> energyUpTo(const Sampled& signal) {
  std::vector<double> sums(signal.size() + 1, 0.0);
  for (std::size_t i = 0; i < signal.size(); ++i) {
    const double x = signal.velocity[0][i];
    const double y = signal.velocity[1][i];
    sums[i + 1] = sums[i] + x * x + y * y;
  }
  return sums;
}

/// Sum over i of left[i + lag] * right[i], for each lag from -(right - 1) to left - 1, both axes together.
std::vector<double> correlated(const Sampled& left, const Sampled& right) {
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

struct Coarse {
  double offset = 0.0;
  double agreement = 0.0;
};

/// Each shift's agreement, of those with enough overlap.
std::vector<Coarse> agreements(const ImageMotion& left_motion, const ImageMotion& right_motion, double step) {
  const Sampled left = sampled(left_motion, step);
  const Sampled right = sampled(right_motion, step);
  const std::vector<double> left_energy = energyUpTo(left);
  const std::vector<double> right_energy = energyUpTo(right);
  const std::vector<double> products = correlated(left, right);
  const auto shorter = static_cast<double>(std::min(left.size(), right.size()));
  const double least_overlap = std::max(kLeastOverlap / step, kLeastOverlapShare * shorter);
  const auto left_size = static_cast<std::ptrdiff_t>(left.size());
  const auto right_size = static_cast<std::ptrdiff_t>(right.size());
  std::vector<Coarse> result;
  for (std::ptrdiff_t lag = 1 - right_size; lag < left_size; ++lag) {
    const std::ptrdiff_t begin = std::max<std::ptrdiff_t>(lag, 0);  // in the left signal
    const std::ptrdiff_t end = std::min(left_size, lag + right_size);
    if (static_cast<double>(end - begin) < least_overlap) continue;
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

Coarse coarseOffset(const ImageMotion& left, const ImageMotion& right, double step) {
  const std::vector<Coarse> all = agreements(left, right, step);
  if (all.empty()) fail("they are too short (5 s of driving are needed)");
  const auto less = [](const Coarse& a, const Coarse& b) { return a.agreement < b.agreement; };
  const Coarse best = *std::max_element(all.begin(), all.end(), less);
  double next = 0.0;
  for (const Coarse& other : all) {
    if (std::abs(other.offset - best.offset) > kApart) next = std::max(next, other.agreement);
  }
  char text[160];
  if (best.agreement < kLeastAgreement) {
    std::snprintf(text, sizeof text,
                  "the two cameras' motions agree by no more than %.2f (1 would be the same)",
                  best.agreement);
    fail(text);
  }
  if (best.agreement - next < kLeastDistinction) {
    std::snprintf(text, sizeof text, "shifts further apart than %.0f s agree as well (%.2f and %.2f)", kApart,
                  best.agreement, next);
    fail(text);
  }
  return best;
}

/// What one part of the right video says.
struct PartOffset {
  double time = 0.0;  ///< of its middle, right
  double offset = 0.0;
  double deviation = 0.0;
};

/// The right camera's steps in a part, each to be explained by the left camera's path.
class Part {
 public:
  Part(const Path& left, const ImageMotion& right, std::size_t first, std::size_t last)
      : left_(left), right_(right), first_(first), last_(last) {}

  /// Mean square of what the left path does not explain; nothing if it does not cover the part.
  std::optional<double> unexplained(double offset) const {
    if (!left_.covers(right_.times[first_] + offset) || !left_.covers(right_.times[last_] + offset))
      return std::nullopt;
    std::array<double, 2> left_square{}, right_square{}, product{};
    cv::Point2d last = left_.at(right_.times[first_] + offset);
    for (std::size_t i = first_ + 1; i <= last_; ++i) {
      const cv::Point2d now = left_.at(right_.times[i] + offset);
      const cv::Point2d l = now - last;
      const cv::Point2d r = right_.positions[i] - right_.positions[i - 1];
      left_square[0] += l.x * l.x;
      left_square[1] += l.y * l.y;
      right_square[0] += r.x * r.x;
      right_square[1] += r.y * r.y;
      product[0] += l.x * r.x;
      product[1] += l.y * r.y;
      last = now;
    }
    // The two lenses may differ in focal length: each axis has a scale.
    double sum = 0.0;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const double explained =
          left_square[axis] > 0.0 ? product[axis] * product[axis] / left_square[axis] : 0.0;
      sum += right_square[axis] - explained;
    }
    return sum / static_cast<double>(last_ - first_);
  }

  double middle() const { return 0.5 * (right_.times[first_] + right_.times[last_]); }
  double steps() const { return static_cast<double>(2 * (last_ - first_)); }

 private:
  const Path& left_;
  const ImageMotion& right_;
  std::size_t first_, last_;
};

/// The minimum within `reach` of `around`, by a parabola through the best of a row of trials.
std::optional<PartOffset> fineOffset(const Part& part, double around, double reach, double step) {
  std::vector<double> trials, costs;
  for (double offset = around - reach; offset <= around + reach; offset += step) {
    const std::optional<double> cost = part.unexplained(offset);
    if (!cost) return std::nullopt;
    trials.push_back(offset);
    costs.push_back(*cost);
  }
  // A parabola through points as far apart as a picture's period would be too coarse, through neighbours too
  // noisy.
  constexpr std::size_t kArm = 5;
  const auto best = static_cast<std::size_t>(std::min_element(costs.begin(), costs.end()) - costs.begin());
  if (best < kArm || best + kArm >= costs.size()) return std::nullopt;
  const double arm = static_cast<double>(kArm) * step;
  const double before = costs[best - kArm];
  const double after = costs[best + kArm];
  const double curvature = (before - 2.0 * costs[best] + after) / (arm * arm);
  if (curvature <= 0.0) return std::nullopt;
  const double shift = std::clamp((before - after) / (2.0 * arm * curvature), -arm, arm);
  const double variance = 2.0 * costs[best] / (curvature * part.steps());
  return PartOffset{part.middle(), trials[best] + shift, std::sqrt(variance) + 1e-6};
}

std::vector<PartOffset> offsetsOfParts(const ImageMotion& left, const ImageMotion& right, double around) {
  const Path path(left);
  const double period = medianStep(right.times);
  const double duration = right.times.back() - right.times.front();
  const double reach = 2.0 * period + 0.5 * kMostSkew * duration;
  // What the left camera did not see while all shifts are tried says nothing.
  const auto seen_by_both = [&](double time) {
    return path.covers(time + around - reach) && path.covers(time + around + reach);
  };
  std::vector<PartOffset> parts;
  const std::size_t pictures = right.times.size();
  std::size_t first = 0;
  while (first < pictures && !seen_by_both(right.times[first]))
    ++first;
  for (std::size_t i = first + 1; i < pictures && seen_by_both(right.times[i]); ++i) {
    const bool is_last = i + 1 == pictures || !seen_by_both(right.times[i + 1]);
    const double length = right.times[i] - right.times[first];
    if (length < kPart && !is_last) continue;
    if (length >= kLeastOverlap) {
      if (const auto found = fineOffset(Part(path, right, first, i), around, reach, period / kFineSteps))
        parts.push_back(*found);
    }
    first = i;
  }
  return parts;
}

double weightOf(const PartOffset& part) {
  return 1.0 / (part.deviation * part.deviation);
}

/// Leaves out parts that lie further off the weighted median than their deviations and skew allow.
void dropStrays(std::vector<PartOffset>& parts) {
  std::sort(parts.begin(), parts.end(),
            [](const PartOffset& a, const PartOffset& b) { return a.offset < b.offset; });
  double total = 0.0;
  for (const PartOffset& part : parts)
    total += weightOf(part);
  double below = 0.0;
  PartOffset median = parts.front();
  for (const PartOffset& part : parts) {
    median = part;
    below += weightOf(part);
    if (below >= 0.5 * total) break;
  }
  std::erase_if(parts, [&](const PartOffset& part) {
    const double bound = 10e-3 + 4.0 * part.deviation + kMostSkew * std::abs(part.time - median.time);
    return std::abs(part.offset - median.offset) > bound;
  });
}

}  // namespace

PictureOffset findOffset(const ImageMotion& left, const ImageMotion& right) {
  requireEnoughPictures("left", left);
  requireEnoughPictures("right", right);
  const double step =
      std::clamp(0.5 * std::min(medianStep(left.times), medianStep(right.times)), 5e-3, 50e-3);
  const Coarse coarse = coarseOffset(left, right, step);
  std::vector<PartOffset> parts = offsetsOfParts(left, right, coarse.offset);
  if (parts.empty()) fail("no part of them shows enough motion");
  dropStrays(parts);

  // A line through the parts: its value at their centre, and its slope.
  double weight = 0.0, centre = 0.0, mean = 0.0, spread = 0.0, product = 0.0;
  for (const PartOffset& part : parts)
    weight += weightOf(part);
  for (const PartOffset& part : parts) {
    centre += weightOf(part) * part.time / weight;
    mean += weightOf(part) * part.offset / weight;
  }
  double begin = parts.front().time, end = begin;
  for (const PartOffset& part : parts) {
    spread += weightOf(part) * (part.time - centre) * (part.time - centre);
    product += weightOf(part) * (part.time - centre) * (part.offset - mean);
    begin = std::min(begin, part.time);
    end = std::max(end, part.time);
  }
  PictureOffset found;
  const bool tells_skew = parts.size() > 3 && end - begin >= kTellsSkew;
  if (tells_skew) found.skew = std::clamp(product / spread, -kMostSkew, kMostSkew);
  found.offset = mean - found.skew * centre;
  found.agreement = coarse.agreement;

  double chi_square = 0.0;
  for (const PartOffset& part : parts) {
    const double miss = part.offset - mean - found.skew * (part.time - centre);
    chi_square += weightOf(part) * miss * miss;
  }
  const double freedom = static_cast<double>(parts.size()) - (tells_skew ? 2.0 : 1.0);
  const double excess = freedom > 0.0 ? std::max(chi_square / freedom, 1.0) : 1.0;
  const double of_mean = std::sqrt(excess / weight);
  const double of_skew = tells_skew ? std::sqrt(excess / spread) * 0.5 * (end - begin) : 0.0;
  found.deviation = std::hypot(std::hypot(of_mean, of_skew), kLeastDeviation);
  return found;
}

}  // namespace cartvo
