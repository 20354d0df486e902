// Affine lower bound of packet arrivals over RTP time.

#include "capture/clock/arrival_clock_model.hpp"

#include <algorithm>
#include <cmath>
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

}  // namespace cartvo::capture
