#include "capture/arrival_line.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "capture/median.hpp"

namespace cartvo {
namespace {

constexpr double kBlock = 2.0;               // s
constexpr std::size_t kMostBlocks = 150;     // crystals wander in longer times
constexpr double kMostSkew = 120e3;          // ns/s: two crystals of 50 ppm, and some
constexpr double kUsualSkew = 50e3;          // ns/s
constexpr double kStep_ns = 100e6;           // no quickest packet is later by so much: a clock was set
constexpr std::size_t kBlocksToBelieve = 5;  // all of them late: not a stall
constexpr double kFirstDeviation_ns = 5e6;   // of a block's quickest packet, before anything is known
constexpr double kLeastDeviation_ns = 50e3;  // what a host takes to wake a thread

double cross(double ax, double ay, double bx, double by) {
  return ax * by - ay * bx;
}

}  // namespace

std::int64_t ArrivalLine::at(std::int64_t rtp_ns) const {
  const std::int64_t since = rtp_ns - origin_rtp_ns_;
  return origin_arrival_ns_ + since + std::llround(lineAt(static_cast<double>(since) * 1e-9));
}

void ArrivalLine::begin(std::int64_t rtp_ns, std::int64_t arrival_ns) {
  origin_rtp_ns_ = rtp_ns;
  origin_arrival_ns_ = arrival_ns;
  blocks_.assign(1, Point{});
  fit();
}

void ArrivalLine::add(std::int64_t rtp_ns, std::int64_t arrival_ns) {
  if (blocks_.empty()) return begin(rtp_ns, arrival_ns);
  const std::int64_t since = rtp_ns - origin_rtp_ns_;
  const Point point{static_cast<double>(since) * 1e-9,
                    static_cast<double>(arrival_ns - origin_arrival_ns_ - since)};
  const double excess = point.delay - lineAt(point.time);
  if (excess < -kStep_ns) {
    ++restarts_;
    return begin(rtp_ns, arrival_ns);
  }
  Point& last = blocks_.back();
  if (std::floor(point.time / kBlock) > std::floor(last.time / kBlock)) {
    dropStaleBlocks();
    blocks_.push_back(point);
    if (blocks_.size() > kMostBlocks) blocks_.pop_front();
    fit();
  } else if (point.delay - slope_ * point.time < last.delay - slope_ * last.time) {
    last = point;
    intercept_ += std::min(excess, 0.0);  // the slope can wait for the block's end
  }
}

/// When every packet comes late for long, what was before no longer holds.
void ArrivalLine::dropStaleBlocks() {
  if (blocks_.size() <= kBlocksToBelieve) return;
  const auto late = blocks_.end() - static_cast<std::ptrdiff_t>(kBlocksToBelieve);
  const bool all_late = std::all_of(late, blocks_.end(),
                                    [this](const Point& p) { return p.delay - lineAt(p.time) > kStep_ns; });
  if (!all_late) return;
  ++restarts_;
  blocks_.erase(blocks_.begin(), late);
}

/// The hull's slope, as far as it is better known than what crystals may do.
void ArrivalLine::fit() {
  const double span = blocks_.back().time - blocks_.front().time;
  const double doubt = deviation_ns_ / (kUsualSkew * std::max(span, kBlock));
  slope_ = std::clamp(hullSlope() / (1.0 + doubt * doubt), -kMostSkew, kMostSkew);
  intercept_ = blocks_.front().delay - slope_ * blocks_.front().time;
  for (const Point& p : blocks_)
    intercept_ = std::min(intercept_, p.delay - slope_ * p.time);
  judge();
}

/// The slope of the lower convex hull's edge under the mean of the times: of all lines below the points the
/// one whose distances from them add up to least.
double ArrivalLine::hullSlope() const {
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

/// How far the line may be off: by how far single blocks lie above it, and by how far all of the latest do.
void ArrivalLine::judge() {
  std::vector<double> above;
  above.reserve(blocks_.size());
  for (const Point& p : blocks_)
    above.push_back(p.delay - lineAt(p.time));
  const auto latest = static_cast<std::ptrdiff_t>(std::min(above.size(), kBlocksToBelieve));
  const double held_up =
      above.size() > kBlocksToBelieve ? *std::min_element(above.end() - latest, above.end()) : 0.0;
  const auto count = static_cast<double>(above.size());
  const double scatter = 2.0 * medianOfDelays(std::move(above)) / std::sqrt(count);
  deviation_ns_ = std::hypot(kLeastDeviation_ns, kFirstDeviation_ns / count, std::hypot(scatter, held_up));
}

}  // namespace cartvo
