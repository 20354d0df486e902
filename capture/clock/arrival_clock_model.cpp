// Affine lower bound of packet arrivals over RTP time, and the pace of arrivals.
#include "capture/clock/arrival_clock_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>
#include <vector>

#include "common/statistics.hpp"

namespace cartvo::capture {
namespace {

constexpr double kMaxSkew_ns = 1e9 * ArrivalClockModel::kMaxCrystalSkew;
constexpr double kBlockLength = 2.0;        // s
constexpr std::size_t kMaxBlocks = 150;     // 5 min; the skew of a crystal drifts over longer times
constexpr double kSkewStddev = 50e3;        // ns/s, prior
constexpr double kMinClockStep_ns = 100e6;  // a change of the least delay by more means that a clock was set
constexpr std::size_t kRecentBlocks = 5;    // if all of them are late, it is not a stall
constexpr double kMinWait_ns = 5e9;         // no network delays pictures for so long and then delivers them
constexpr double kBlockStddev_ns = 5e6;     // prior of a block's fastest packet
constexpr double kMinStddev_ns = 50e3;      // time a host takes to wake a thread

// Skew that is no crystal's: a camera that counts a nominal frame rate. Followed as far as ArrivalPace
// tolerates it, with a margin in which that names it, once the arrivals' drift beyond a crystal's exceeds
// what their scatter explains.
constexpr double kMaxNominalSkew = 8e6;  // ns/s
constexpr double kMinNominalDrift_ns = 8e6;
constexpr double kNominalDriftOfScatter = 6.0;  // of the median distance from the hull's edge
constexpr std::size_t kMinNominalBlocks = 6;

double cross(double ax, double ay, double bx, double by) {
  return ax * by - ay * bx;
}

// Settling. Two halves of 0.2 s whose fastest pictures differ by less than the tolerance: 5 % of the pace.
constexpr std::int64_t kSettlingTime_ns = 400'000'000;
constexpr std::size_t kSettlingPictures = 6;
constexpr std::int64_t kMinTolerance_ns = 10'000'000;  // the default limit of the offset's uncertainty
// Of the mean deviation within a half. That of arrivals off the pace is a quarter of the halves' difference.
constexpr double kToleranceOfScatter = 2.0;
// A path that was congested from the beginning becomes free within this time, or is the usual one.
constexpr std::int64_t kYoung_ns = 6'000'000'000;

// Pace.
constexpr std::int64_t kBlock_ns = 500'000'000;
constexpr std::size_t kBlocks = 12;
constexpr std::size_t kBlocksToFindFast = 6;
// Pictures that arrive a little later each may also be those of a network that fills up.
constexpr std::size_t kBlocksToFindSlow = kBlocks;
constexpr double kMinSteadiness = 0.5;   // of the slope, between neighbours: else it is that of one step
constexpr double kMaxDeviation = 0.005;  // crystals: 1e-4
constexpr double kMinDrift_ns = 40e6;    // over all blocks
constexpr double kDriftOfScatter = 4.0;  // of the blocks' median deviation from a straight line
constexpr double kMinPeriod_ns = 1e9 / 240.0;  // of a camera; shorter steps are no congestion's

// Evenness.
constexpr std::size_t kSteps = 64;
constexpr double kLongStep = 1.5;          // median steps; longer ones span lost frames
constexpr double kMinUnevenness_ns = 2e6;  // less changes a velocity by less than the pictures' noise does
constexpr double kMaxSlope = 0.5;          // of the arrivals' steps over those of RTP time: 1 if that is true
constexpr double kSlopeSignificance = 4.0;  // standard deviations from 1

/// Mean distance of the delays from their mean, ns.
template <typename Iterator>
double scatterOf(Iterator begin, Iterator end) {
  const auto count = static_cast<double>(end - begin);
  double mean = 0.0;
  for (Iterator i = begin; i != end; ++i)
    mean += static_cast<double>(i->delay_ns) / count;
  double scatter = 0.0;
  for (Iterator i = begin; i != end; ++i)
    scatter += std::abs(static_cast<double>(i->delay_ns) - mean) / count;
  return scatter;
}

}  // namespace

std::int64_t ArrivalClockModel::at(std::int64_t rtp_ns) const {
  const std::int64_t since = rtp_ns - origin_rtp_ns_;
  return origin_arrival_ns_ + since + std::llround(delayAt(static_cast<double>(since) * 1e-9));
}

void ArrivalClockModel::begin(std::int64_t rtp_ns, std::int64_t arrival_ns) {
  origin_rtp_ns_ = rtp_ns;
  origin_arrival_ns_ = arrival_ns;
  blocks_.assign(1, Point{});
  fit();
}

void ArrivalClockModel::add(std::int64_t rtp_ns, std::int64_t arrival_ns) {
  if (blocks_.empty()) return begin(rtp_ns, arrival_ns);
  const std::int64_t since = rtp_ns - origin_rtp_ns_;
  const Point point{static_cast<double>(since) * 1e-9,
                    static_cast<double>(arrival_ns - origin_arrival_ns_ - since)};
  const double excess = point.delay - delayAt(point.time);
  if (excess < -kMinClockStep_ns) {
    ++restarts_;
    return begin(rtp_ns, arrival_ns);
  }
  Point& last = blocks_.back();
  if (std::floor(point.time / kBlockLength) > std::floor(last.time / kBlockLength)) {
    if (waitedFor(last, point)) {
      last = point;
      return;
    }
    dropStaleBlocks();
    blocks_.push_back(point);
    if (blocks_.size() > kMaxBlocks) blocks_.pop_front();
    fit();
  } else if (point.delay - slope_ * point.time < last.delay - slope_ * last.time) {
    last = point;
    intercept_ += std::min(excess, 0.0);  // the slope is fitted at the block's end
  }
}

/// Whether a block's pictures waited to be read, because this process stood still: the next block's arrived
/// with them.
bool ArrivalClockModel::waitedFor(const Point& block, const Point& next) const {
  const double step = next.time - block.time;
  return block.delay - delayAt(block.time) > kMinWait_ns &&
         step + 1e-9 * (next.delay - block.delay) < 0.5 * step;
}

void ArrivalClockModel::forgetEarlierBlocks() {
  blocks_.erase(blocks_.begin(), blocks_.end() - 1);
  fit();
}

/// Drops all but the recent blocks if every recent block is late: a clock was set.
void ArrivalClockModel::dropStaleBlocks() {
  if (blocks_.size() <= kRecentBlocks) return;
  const auto late = blocks_.end() - static_cast<std::ptrdiff_t>(kRecentBlocks);
  const bool all_late = std::all_of(
      late, blocks_.end(), [this](const Point& p) { return p.delay - delayAt(p.time) > kMinClockStep_ns; });
  if (!all_late) return;
  ++restarts_;
  blocks_.erase(blocks_.begin(), late);
}

/// Fits the bound. Shrinks the hull's slope towards 0 by its variance against the prior of a crystal's skew.
void ArrivalClockModel::fit() {
  const double span = blocks_.back().time - blocks_.front().time;
  const double noise_to_signal = stddev_ns_ / (kSkewStddev * std::max(span, kBlockLength));
  const double hull = hullSlope();
  slope_ = isNominal(hull, span)
               ? hull
               : std::clamp(hull / (1.0 + noise_to_signal * noise_to_signal), -kMaxSkew_ns, kMaxSkew_ns);
  intercept_ = leastAt0(slope_);
  updateStddev();
}

/// Value at time 0 of the line of this slope below all blocks.
double ArrivalClockModel::leastAt0(double slope) const {
  double least = blocks_.front().delay - slope * blocks_.front().time;
  for (const Point& p : blocks_)
    least = std::min(least, p.delay - slope * p.time);
  return least;
}

/// Whether the skew is neither a crystal's nor due to the scatter of the arrivals.
bool ArrivalClockModel::isNominal(double slope, double span) const {
  const double drift = (std::abs(slope) - kMaxSkew_ns) * span;
  if (blocks_.size() < kMinNominalBlocks || drift < kMinNominalDrift_ns || std::abs(slope) > kMaxNominalSkew)
    return false;
  const double intercept = leastAt0(slope);
  std::vector<double> above;
  above.reserve(blocks_.size());
  for (const Point& p : blocks_)
    above.push_back(p.delay - intercept - slope * p.time);
  return drift > kMinNominalDrift_ns + kNominalDriftOfScatter * medianOf(std::move(above));
}

/// Slope of the lower convex hull's edge below the mean time. Of all lines below the points, this one has the
/// least sum of distances to them.
double ArrivalClockModel::hullSlope() const {
  std::vector<Point> hull;
  double mean = 0.0;
  for (const Point& p : blocks_) {
    mean += p.time / static_cast<double>(blocks_.size());
    while (hull.size() > 1) {
      const Point& a = hull[hull.size() - 2];
      const Point& b = hull.back();
      if (cross(b.time - a.time, b.delay - a.delay, p.time - a.time, p.delay - a.delay) > 0.0) break;
      hull.pop_back();
    }
    hull.push_back(p);
  }
  for (std::size_t i = 1; i < hull.size(); ++i) {
    if (hull[i].time < mean) continue;
    return (hull[i].delay - hull[i - 1].delay) / (hull[i].time - hull[i - 1].time);
  }
  return 0.0;
}

/// Computes the standard deviation from the scatter of the blocks above the bound and from the least distance
/// of the recent blocks.
void ArrivalClockModel::updateStddev() {
  std::vector<double> above;
  above.reserve(blocks_.size());
  for (const Point& p : blocks_)
    above.push_back(p.delay - delayAt(p.time));
  const auto latest = static_cast<std::ptrdiff_t>(std::min(above.size(), kRecentBlocks));
  const double recent_delay =
      above.size() > kRecentBlocks ? *std::min_element(above.end() - latest, above.end()) : 0.0;
  const auto count = static_cast<double>(above.size());
  const double scatter = 2.0 * medianOf(std::move(above)) / std::sqrt(count);
  stddev_ns_ = std::hypot(kMinStddev_ns, kBlockStddev_ns / count, std::hypot(scatter, recent_delay));
}

void ArrivalPace::add(std::int64_t rtp_ns, std::int64_t arrival_ns) {
  const Point point{arrival_ns, arrival_ns - rtp_ns};
  if (!first_arrival_ns_) first_arrival_ns_ = arrival_ns;
  const bool is_young = arrival_ns - *first_arrival_ns_ < kYoung_ns;
  if (settled_ && is_young && point.delay_ns < least_delay_ns_ - tolerance_ns_) {
    settled_ = false;  // earlier pictures were late
    window_.clear();
  }
  if (!settled_) settle(point);
  least_delay_ns_ = std::min(least_delay_ns_, point.delay_ns);
  addToBlocks(point);
  addStep(point);
}

void ArrivalPace::addStep(const Point& point) {
  if (last_) {
    const std::int64_t arrival_step = point.arrival_ns - last_->arrival_ns;
    steps_.push_back({static_cast<double>(arrival_step - (point.delay_ns - last_->delay_ns)),
                      static_cast<double>(arrival_step)});
    if (steps_.size() > kSteps) steps_.pop_front();
  }
  last_ = point;
  if (steps_.size() == kSteps) compareSteps();
}

/// Median step of RTP time, ns. Requires two pictures.
double ArrivalPace::medianStep() const {
  std::vector<double> steps;
  for (const Step& step : steps_)
    steps.push_back(step.rtp_ns);
  return medianOf(std::move(steps));
}

/// Regression of the arrivals' steps on those of RTP time. Its slope is 1 if pictures are sent as they are
/// exposed, and 0 if they are exposed evenly and only their RTP time is uneven.
void ArrivalPace::compareSteps() {
  unevenness_.reset();
  for (const Step& step : steps_)
    if (step.rtp_ns <= 0.0) return;  // B-frames arrive in another order
  const double longest = kLongStep * medianStep();
  double count = 0.0;
  Step mean;
  for (const Step& step : steps_) {
    if (step.rtp_ns > longest) continue;
    count += 1.0;
    mean.rtp_ns += step.rtp_ns;
    mean.arrival_ns += step.arrival_ns;
  }
  mean = {mean.rtp_ns / count, mean.arrival_ns / count};
  double rtp_rtp = 0.0;
  double rtp_arrival = 0.0;
  double arrival_arrival = 0.0;
  for (const Step& step : steps_) {
    if (step.rtp_ns > longest) continue;
    const double rtp = step.rtp_ns - mean.rtp_ns;
    const double arrival = step.arrival_ns - mean.arrival_ns;
    rtp_rtp += rtp * rtp;
    rtp_arrival += rtp * arrival;
    arrival_arrival += arrival * arrival;
  }
  const double rms = std::sqrt(rtp_rtp / count);
  if (rms < kMinUnevenness_ns) return;
  const double slope = rtp_arrival / rtp_rtp;
  const double residual = std::max(arrival_arrival - slope * rtp_arrival, 0.0);
  const double stddev = std::sqrt(residual / (count - 2.0) / rtp_rtp);
  if (slope < kMaxSlope && slope < 1.0 - kSlopeSignificance * stddev) unevenness_ = rms;
}

void ArrivalPace::settle(const Point& point) {
  window_.push_back(point);
  if (window_.size() < kSettlingPictures || point.arrival_ns - window_.front().arrival_ns < kSettlingTime_ns)
    return;
  const auto middle = window_.begin() + static_cast<std::ptrdiff_t>(window_.size() / 2);
  const auto earlier = [](const Point& a, const Point& b) { return a.delay_ns < b.delay_ns; };
  const std::int64_t first = std::min_element(window_.begin(), middle, earlier)->delay_ns;
  const std::int64_t second = std::min_element(middle, window_.end(), earlier)->delay_ns;
  const double scatter = 0.5 * (scatterOf(window_.begin(), middle) + scatterOf(middle, window_.end()));
  tolerance_ns_ = std::max<std::int64_t>(kMinTolerance_ns, std::llround(kToleranceOfScatter * scatter));
  settled_ = std::abs(second - first) <= tolerance_ns_;
  if (settled_) {
    least_delay_ns_ = std::min(first, second);
    window_.clear();
  } else {
    window_.erase(window_.begin(), middle);
  }
}

void ArrivalPace::addToBlocks(const Point& point) {
  if (!blocks_.empty() && point.arrival_ns - block_begin_ns_ < kBlock_ns) {
    if (point.delay_ns < blocks_.back().delay_ns) blocks_.back() = point;
    return;
  }
  comparePace();  // the last block is complete
  blocks_.push_back(point);
  block_begin_ns_ = point.arrival_ns;
  // A deviation that was found ends with the latest blocks.
  while (blocks_.size() > (deviation_ ? kBlocksToFindFast : kBlocks))
    blocks_.pop_front();
}

/// The slope of the blocks' delays by Theil and Sen (the median slope of all pairs), and whether it is more
/// than their scatter explains.
void ArrivalPace::comparePace() {
  if (blocks_.size() < kBlocksToFindFast) return;
  const auto time = [&](std::size_t i) {
    return static_cast<double>(blocks_[i].arrival_ns - blocks_.front().arrival_ns);
  };
  const auto delay = [&](std::size_t i) {
    return static_cast<double>(blocks_[i].delay_ns - blocks_.front().delay_ns);
  };
  std::vector<double> slopes;
  std::vector<double> adjacent;  // of neighbours alone: one late time does not move their median
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    if (i > 0 && time(i) > time(i - 1))
      adjacent.push_back((delay(i) - delay(i - 1)) / (time(i) - time(i - 1)));
    for (std::size_t j = i + 1; j < blocks_.size(); ++j)
      if (time(j) > time(i)) slopes.push_back((delay(j) - delay(i)) / (time(j) - time(i)));
  }
  if (adjacent.empty()) return;
  const double slope = medianOf(std::move(slopes));
  std::vector<double> levels;
  for (std::size_t i = 0; i < blocks_.size(); ++i)
    levels.push_back(delay(i) - slope * time(i));
  const double level = medianOf(levels);
  for (double& value : levels)
    value = std::abs(value - level);
  const double drift = std::abs(slope) * time(blocks_.size() - 1);
  const bool is_slow = slope > 0.0;  // pictures arrive ever later
  const bool may_be_network = is_slow && medianStep() > kMinPeriod_ns;
  const bool is_known = deviation_ || !may_be_network || blocks_.size() >= kBlocksToFindSlow;
  const bool is_steady = medianOf(std::move(adjacent)) / slope > kMinSteadiness;
  const bool is_wrong = is_known && is_steady && std::abs(slope) > kMaxDeviation &&
                        drift > kMinDrift_ns + kDriftOfScatter * medianOf(std::move(levels));
  deviation_ = is_wrong ? std::optional(-slope) : std::nullopt;
}

}  // namespace cartvo::capture
