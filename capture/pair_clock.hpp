#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>

#include "capture/camera_side.hpp"
#include "capture/frame.hpp"
#include "capture/stream_clock.hpp"

namespace cartvo {

/// Which witnesses relate the two cameras' exposures.
enum class ClockChoice : std::uint8_t {
  automatic,  ///< all there are, each by its uncertainty, but for those that the others refute
  ntp,        ///< the cameras' own clocks by their sender reports; arrival until there are any
  arrival,    ///< the host's clock at reception: both cameras are taken to have one latency
  visual,     ///< what both pictures show; arrival until that is known
};

/// How a picture was stamped.
struct StampedInstant {
  std::int64_t exposure_ns = 0;   ///< host's clock, ns since the Unix epoch
  std::int64_t deviation_ns = 0;  ///< standard deviation against the other camera, half the variance
  std::int64_t undelayed_arrival_ns = 0;
  InstantSource source = InstantSource::arrival;
};

/// An offset with its standard deviation, ns.
struct ClockWitness {
  double value_ns = 0.0;
  double deviation_ns = 0.0;
};

/// What is in use, for health reports.
struct ClockStatus {
  struct Camera {
    std::optional<double> latency_ns;  ///< exposure to undelayed arrival, by its reports
    double skew = 0.0;                 ///< of its RTP clock against the host's, 1
    std::uint64_t steps = 0;           ///< times that its clock was set
  };
  std::array<Camera, 2> cameras;  ///< left, right
  InstantSource source = InstantSource::arrival;
  ClockWitness offset;                 ///< what is added to right minus left by arrival; 0 if latencies agree
  std::optional<ClockWitness> ntp;     ///< the same by the reports alone
  std::optional<ClockWitness> visual;  ///< and by the pictures alone
  std::string problem;                 ///< what a person should mend about the clocks; empty if all is well
};

/// Relates both cameras' exposures to the host's clock and, more exactly, to each other. From any thread.
///
/// Three witnesses know how much later the right camera is exposed: arrival, as far as both cameras take
/// equally long from exposure to sending; their sender reports, as far as their clocks agree; and the
/// pictures. Each errs in its own way, so each has an uncertainty, and one that is refuted by the others does
/// not count. What both cameras are late by in common comes from the reports. Corrections are made gradually,
/// at 0.5 % of the time that passes, so that no exposure is before the one before and no pose jumps.
class PairClock {
 public:
  explicit PairClock(ClockChoice choice);

  /// The camera opened a connection.
  void connect(CameraSide side);

  /// The next picture of that camera.
  StampedInstant stamp(CameraSide side, const StampedPacket& packet);

  /// By the pictures, right minus left exposure is `offset` later than by undelayed arrival; nothing if they
  /// do not tell.
  void setVisual(const std::optional<ClockWitness>& offset);

  ClockStatus status() const;

 private:
  struct Side {
    explicit Side(double usual_scatter_ns) : clock(usual_scatter_ns) {}

    StreamClock clock;
    bool connected = false;                        ///< has a picture of this connection
    std::int64_t last_rtp_ns = 0;                  ///< of the picture before, if connected
    std::uint64_t last_restarts = 0;               ///< of its arrival line, likewise
    std::int64_t last_arrival_ns = 0;              ///< of that picture, also on an earlier connection
    std::optional<std::int64_t> last_exposure_ns;  ///< as given out, likewise
    double target_ns = 0.0;                        ///< exposure minus undelayed arrival as it should be
    double lag_ns = 0.0;                           ///< exposure as given out minus as it should be
  };

  void relate();
  ClockWitness byArrival() const;
  std::optional<ClockWitness> byReports() const;
  void choose(const ClockWitness& arrival);
  void combine(const ClockWitness& arrival);
  std::string problem() const;
  double commonLatencyNs() const;
  static std::int64_t slewed(Side& side, std::int64_t arrival_ns);

  mutable std::mutex mutex_;
  ClockChoice choice_;
  std::array<Side, 2> sides_;
  std::optional<ClockWitness> reports_;
  std::optional<ClockWitness> visual_;
  bool reports_count_ = false;  ///< they agree with the others
  ClockWitness offset_;
  InstantSource source_ = InstantSource::arrival;
};

}  // namespace cartvo
