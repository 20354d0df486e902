#pragma once

#include <cstdint>
#include <deque>

namespace cartvo {

/// Where a camera's packets would arrive if nothing ever held one up: the line under all their arrivals over
/// RTP time, whose slope is the RTP clock's skew against the host's. Delay in a network is one-sided, so the
/// quickest packets tell it to a fraction of the usual jitter. (S. Moon, P. Skelly, D. Towsley: "Estimation
/// and removal of clock skew from network delay measurements", INFOCOM 1999.) Pure.
class ArrivalLine {
 public:
  /// A picture with RTP time `rtp_ns` (unwrapped, increasing) arrived.
  void add(std::int64_t rtp_ns, std::int64_t arrival_ns);

  bool known() const { return !blocks_.empty(); }

  /// Whether it rests on more than the first few seconds.
  bool settled() const { return blocks_.size() > 2; }

  /// Host's clock, ns since the Unix epoch. Only if known.
  std::int64_t at(std::int64_t rtp_ns) const;

  /// Standard deviation of `at` for the latest pictures, ns.
  double deviationNs() const { return deviation_ns_; }

  /// Host's seconds in a second of RTP time, minus 1.
  double skew() const { return slope_ * 1e-9; }

  /// How often it had to begin anew, because the host's clock was set or the camera's RTP clock jumped.
  std::uint64_t restarts() const { return restarts_; }

 private:
  /// The quickest picture of a block of two seconds.
  struct Point {
    double time = 0.0;   ///< RTP, s from the first picture
    double delay = 0.0;  ///< arrival minus RTP time, ns, from the first picture's
  };

  double lineAt(double time) const { return intercept_ + slope_ * time; }
  void begin(std::int64_t rtp_ns, std::int64_t arrival_ns);
  void dropStaleBlocks();
  void fit();
  double hullSlope() const;
  void judge();

  std::int64_t origin_rtp_ns_ = 0;
  std::int64_t origin_arrival_ns_ = 0;
  std::deque<Point> blocks_;
  double intercept_ = 0.0;  ///< ns
  double slope_ = 0.0;      ///< ns/s
  double deviation_ns_ = 0.0;
  std::uint64_t restarts_ = 0;
};

}  // namespace cartvo
