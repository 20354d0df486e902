#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

namespace cartvo::capture {

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
