#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

namespace cartvo::capture {

/// Clock model of a camera's RTP clock against the host's clock, from packet arrivals: the affine lower bound
/// of all arrivals over RTP time. Its value is the arrival of a packet with the least network delay, its
/// slope the skew of the RTP clock. Network delay is one-sided, so the fastest packets determine the bound to
/// a fraction of the usual jitter. (S. Moon, P. Skelly, D. Towsley: "Estimation and removal of clock skew
/// from network delay measurements", INFOCOM 1999.) Reads no clock; deterministic.
class ArrivalClockModel {
 public:
  /// Skew of two crystals of 50 ppm each, and a margin. More is that of a camera which counts a nominal frame
  /// rate.
  static constexpr double kMaxCrystalSkew = 120e-6;

  /// Adds a picture: RTP time `rtp_ns` (unwrapped, increasing) and arrival by the host's clock.
  void add(std::int64_t rtp_ns, std::int64_t arrival_ns);

  /// Keeps only the current two seconds.
  void forgetEarlierBlocks();

  bool hasData() const { return !blocks_.empty(); }

  /// Whether the model covers more than the first few seconds.
  bool isMature() const { return blocks_.size() > 2; }

  /// Arrival at the least delay, ns since the Unix epoch, host's clock. Requires hasData().
  std::int64_t at(std::int64_t rtp_ns) const;

  /// Standard deviation of `at` for the latest pictures, ns.
  double stddevNs() const { return stddev_ns_; }

  /// Host seconds per second of RTP time, minus 1.
  double skew() const { return slope_ * 1e-9; }

  /// Number of restarts, because the host's clock was set or the camera's RTP clock jumped.
  std::uint64_t restarts() const { return restarts_; }

 private:
  /// The fastest picture of a block of two seconds.
  struct Point {
    double time = 0.0;   ///< RTP, s from the first picture
    double delay = 0.0;  ///< arrival minus RTP time, ns, relative to the first picture
  };

  double delayAt(double time) const { return intercept_ + slope_ * time; }
  void begin(std::int64_t rtp_ns, std::int64_t arrival_ns);
  void dropStaleBlocks();
  void fit();
  bool waitedFor(const Point& block, const Point& next) const;
  double leastAt0(double slope) const;
  bool isNominal(double slope, double span) const;
  double hullSlope() const;
  void updateStddev();

  std::int64_t origin_rtp_ns_ = 0;
  std::int64_t origin_arrival_ns_ = 0;
  std::deque<Point> blocks_;
  double intercept_ = 0.0;  ///< ns
  double slope_ = 0.0;      ///< ns/s
  double stddev_ns_ = 0.0;
  std::uint64_t restarts_ = 0;
};

/// Tests whether a stream's RTP time can be used: whether pictures arrive at the pace at which RTP time
/// advances. They do not while a camera or a relay sends its backlog at the start of a connection, and never
/// if a camera counts a nominal frame rate that it does not reach. Network delay only delays, so that the
/// fastest arrivals are compared. Reads no clock; deterministic.
class ArrivalPace {
 public:
  /// Adds a picture: RTP time (unwrapped) and arrival by the host's clock, ns.
  void add(std::int64_t rtp_ns, std::int64_t arrival_ns);

  /// Whether the last pictures have arrived at the pace of RTP time, so that their instants are known. Takes
  /// 0.4 s of a connection at least.
  bool isSettled() const { return settled_ && !deviation_; }

  /// RTP seconds per second of the host's clock, minus 1, if neither a crystal nor the scatter of the
  /// arrivals explains it; found after 3 s or more.
  std::optional<double> deviation() const { return deviation_; }

  /// RMS deviation of RTP time's steps from even ones, ns, if the pictures arrive evenly, so that the steps
  /// are not those of the exposures: RTP time is rounded, or of a later stage than the exposure.
  std::optional<double> unevenness() const { return unevenness_; }

 private:
  struct Point {
    std::int64_t arrival_ns = 0;
    std::int64_t delay_ns = 0;  ///< arrival minus RTP time
  };

  /// From one picture to the next.
  struct Step {
    double rtp_ns = 0.0;
    double arrival_ns = 0.0;
  };

  void settle(const Point& point);
  void addToBlocks(const Point& point);
  void comparePace();
  void addStep(const Point& point);
  void compareSteps();
  double medianStep() const;

  std::deque<Point> window_;  ///< pictures since the pace was last found wrong, until it is settled
  std::optional<std::int64_t> first_arrival_ns_;
  bool settled_ = false;
  std::int64_t least_delay_ns_ = 0;  ///< since it is settled
  std::int64_t tolerance_ns_ = 0;    ///< of a change of it, by the scatter of the arrivals
  std::deque<Point> blocks_;         ///< the fastest picture of each half second
  std::int64_t block_begin_ns_ = 0;
  std::optional<double> deviation_;
  std::optional<Point> last_;
  std::deque<Step> steps_;  ///< the latest ones
  std::optional<double> unevenness_;
};

}  // namespace cartvo::capture
