#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>

#include "capture/camera_side.hpp"
#include "capture/clock/camera_clock_model.hpp"
#include "capture/encoded_unit.hpp"
#include "capture/frame.hpp"

// Exposure time stamps of two IP cameras on the host's clock.

namespace cartvo::capture {

/// Which offset estimates relate the two cameras' exposures.
enum class ClockChoice : std::uint8_t {
  automatic,  ///< all available ones, weighted by their variances, except those that the others reject
  ntp,        ///< the cameras' wall clocks by their sender reports; arrival until there are reports
  arrival,    ///< the host's clock at reception; assumes that both cameras have the same latency
  visual,     ///< the image content of both cameras; arrival until that is estimated
};

/// The time stamps assigned to one picture.
struct ExposureTimestamp : ExposureInstant {
  bool is_usable = true;  ///< false: the RTP time cannot be, and the instants are no picture's
};

/// Puts the time stamps into a unit. A picture whose RTP time cannot be is marked as damaged: it is decoded,
/// as later ones refer to it, but not used.
void setTimestamp(EncodedUnit& unit, const ExposureTimestamp& timestamp);

/// Estimate of the clock offset between the two cameras: right minus left exposure, relative to right minus
/// left minimum-delay arrival.
struct OffsetEstimate {
  double value_ns = 0.0;
  double stddev_ns = 0.0;
};

/// State of the clock models, for health reports.
struct ClockStatus {
  struct Camera {
    std::optional<double> latency_ns;  ///< exposure to minimum-delay arrival, by the sender reports
    double skew = 0.0;                 ///< RTP clock against the host's clock, relative
    std::uint64_t steps = 0;           ///< number of times the camera's wall clock was set
    std::uint64_t left_out = 0;        ///< sender reports that contradict the others
  };
  std::array<Camera, 2> cameras;  ///< left, right
  InstantSource source = InstantSource::arrival;
  OffsetEstimate offset;                 ///< the offset in use; 0 if both cameras have the same latency
  std::optional<OffsetEstimate> ntp;     ///< by the sender reports alone
  std::optional<OffsetEstimate> visual;  ///< by the image content alone
  std::string problem;                   ///< what the user should change about the clocks; empty if nothing
  std::string advice;  ///< what of the sender reports is not used, though nothing fails by that; or empty
};

/// Timestamps the pictures of two cameras: relates their exposures to the host's clock and, more precisely,
/// to each other. Thread-safe.
///
/// Three independent estimates of the offset between the cameras are combined by their variances:
/// - arrival, valid as far as both cameras take equally long from exposure to sending;
/// - sender reports, valid as far as the cameras' wall clocks agree;
/// - image content.
/// An estimate that the others reject at three standard deviations is not used. The latency that both cameras
/// have in common comes from the sender reports. Corrections are slewed at 0.5 % of the elapsed time, so that
/// exposures always increase and poses do not jump; `slew_ns` tells by how much, so that time steps can be
/// taken from RTP time alone. Until the arrivals of both cameras follow RTP time (ArrivalPace), the standard
/// deviation is so large that no motion is valid.
class StereoTimestamper {
 public:
  explicit StereoTimestamper(ClockChoice choice);

  /// Begins a new connection of the camera.
  void connect(CameraSide side);

  /// Timestamps the camera's next picture.
  ExposureTimestamp stamp(CameraSide side, const RtpTimestamps& timestamps);

  /// Sets the offset estimated from the image content; nothing if there is none.
  void setVisual(const std::optional<OffsetEstimate>& offset);

  /// Sets by how much the host's wall clock is ahead of the clock of the arrivals (hostClockCorrection()).
  /// The cameras' wall clocks are compared with the former.
  void setHostClockCorrection(std::int64_t correction_ns);

  /// Sets what is said of the camera's sender reports that were left out; empty: none were.
  void setReportNote(CameraSide side, const std::string& note);

  ClockStatus status() const;

 private:
  struct Side {
    explicit Side(double default_scatter_ns) : clock(default_scatter_ns) {}

    CameraClockModel clock;
    bool connected = false;                        ///< a picture of this connection was timestamped
    std::int64_t last_rtp_ns = 0;                  ///< of the previous picture, if connected
    std::uint64_t last_restarts = 0;               ///< restarts of the arrival model at that picture
    std::uint64_t last_epoch = 0;                  ///< epoch of RTP time at that picture
    std::int64_t last_arrival_ns = 0;              ///< of the previous picture, also of an earlier connection
    std::optional<std::int64_t> last_exposure_ns;  ///< as returned for that picture
    double target_ns = 0.0;                        ///< desired exposure minus minimum-delay arrival
    double lag_ns = 0.0;                           ///< returned exposure minus desired one
    std::int64_t slew_ns = 0;                      ///< as Frame's, of that picture
  };

  void updateTargets(std::int64_t arrival_ns);
  void slewLatency(std::int64_t arrival_ns);
  OffsetEstimate offsetByArrival() const;
  std::optional<OffsetEstimate> offsetByReports() const;
  void selectOffset(const OffsetEstimate& arrival);
  void combineOffsets(const OffsetEstimate& arrival);
  std::string problem() const;
  double commonLatencyNs() const;
  double hostLatencyNs(std::int64_t latency_ns) const;
  std::string missingReports(std::size_t side) const;
  std::string advice() const;
  std::string uncertaintyProblem() const;
  double uncertainty() const;
  static void advance(Side& side, std::int64_t arrival_ns);
  static std::int64_t slewedExposureNs(const Side& side, std::int64_t target_ns, std::int64_t step_ns);

  mutable std::mutex mutex_;
  ClockChoice choice_;
  std::array<Side, 2> sides_;
  std::optional<OffsetEstimate> reports_;
  std::optional<OffsetEstimate> visual_;
  double latency_ns_ = 0.0;                    ///< common to both cameras, as slewed
  std::optional<std::int64_t> latency_at_ns_;  ///< arrival up to which it is slewed
  bool reports_agree_ = false;  ///< the reports' offset passes the gate against the other estimates
  OffsetEstimate offset_;
  double uncertain_share_ = 0.0;  ///< of the latest pictures: their offset's standard deviation is large
  InstantSource source_ = InstantSource::arrival;
  double host_clock_correction_ns_ = 0.0;
  std::array<std::string, 2> report_notes_;  ///< left, right
};

}  // namespace cartvo::capture
