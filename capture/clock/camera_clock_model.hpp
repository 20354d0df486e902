#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "capture/clock/arrival_clock_model.hpp"
#include "capture/clock/sender_report_clock_model.hpp"

// Clock models of one IP camera, from packet arrivals and sender reports.

namespace cartvo::capture {

/// The time stamps of one picture as received.
struct RtpTimestamps {
  std::int64_t pts = 0;                      ///< RTP time stamp, 1/90000 s; only the lower 32 bits are used
  std::optional<std::int64_t> reference_us;  ///< exposure by the last sender report, us since 1970
  std::int64_t arrival_ns = 0;               ///< of the picture's first packet, host's clock
};

/// Clock models of one camera: its RTP clock against the host's clock (from arrivals) and against the
/// camera's wall clock (from sender reports). Reads no clock; deterministic.
///
/// The RTP clock runs on a crystal and is exact from picture to picture. The fastest arrivals relate it to
/// the host's clock to about 0.1 ms, except for the camera's latency, which arrivals do not show. Sender
/// reports give the instant of exposure without latency, but by the camera's wall clock and with the noise of
/// its stamping.
class CameraClockModel {
 public:
  /// `default_scatter_ns`: as SenderReportClockModel's.
  explicit CameraClockModel(double default_scatter_ns)
      : default_scatter_ns_(default_scatter_ns), reports_(default_scatter_ns) {}

  /// Begins a new connection, with which RTP time restarts.
  void connect();

  /// Adds the next picture. False if its RTP time cannot be: nothing changes. Where the pictures go on from
  /// another RTP time (a camera's encoder restarts within a connection), the clock begins anew with the third
  /// of them.
  bool add(const RtpTimestamps& timestamps);

  /// Changes when RTP time begins anew: with a connection, and after a jump.
  std::uint64_t epoch() const { return epoch_; }

  /// Fault of the stream's RTP time: it is unsteady, jumped, or is not that of the exposures. "jumped by
  /// ..."; empty if there is none.
  std::string timeBaseProblem() const;

  /// Whether the arrivals follow RTP time, and if not, by how much it is off.
  const ArrivalPace& pace() const { return pace_; }

  /// Duration of this connection, s of RTP time.
  double seconds() const { return static_cast<double>(rtp_ns_ - first_rtp_ns_.value_or(rtp_ns_)) * 1e-9; }

  /// RTP time of the last picture, ns, unwrapped.
  std::int64_t rtpNs() const { return rtp_ns_; }

  /// Arrival that the last picture would have had with the least network delay, ns, host's clock. Requires a
  /// picture.
  std::int64_t minDelayArrivalNs() const { return arrivals_.at(rtp_ns_); }
  const ArrivalClockModel& arrivals() const { return arrivals_; }

  /// Exposure of the last picture by the camera's wall clock, ns; nothing before the first report.
  std::optional<std::int64_t> reportedNs() const;
  double reportedStddevNs() const { return reports_.stddevNs(rtp_ns_); }
  const SenderReportClockModel& reports() const { return reports_; }

  /// Latency, ns: arrival at the least network delay (host's clock) minus exposure (camera's wall clock);
  /// nothing while its standard deviation exceeds 12 ms.
  std::optional<std::int64_t> latencyNs() const;

 private:
  /// Pictures whose RTP time does not follow from the earlier ones.
  struct Strays {
    std::int64_t rtp_ns = 0;      ///< of the last one
    std::int64_t arrival_ns = 0;  ///< of the last one
    int count = 0;                ///< in a row, consistent among themselves
  };

  void begin();
  std::int64_t unwrapped(std::int64_t pts) const;
  bool isPlausible(std::int64_t rtp_ns, std::int64_t arrival_ns) const;
  bool beginsEpoch(std::int64_t rtp_ns, std::int64_t arrival_ns);
  void addReport(const RtpTimestamps& timestamps);

  double default_scatter_ns_;
  ArrivalClockModel arrivals_;
  ArrivalPace pace_;
  SenderReportClockModel reports_;
  SenderReportExtractor report_extractor_;
  std::optional<std::int64_t> last_pts_;
  std::optional<std::int64_t> first_rtp_ns_;
  std::int64_t rtp_ns_ = 0;
  Strays strays_;
  std::uint32_t latest_strays_ = 0;  ///< a bit for each of the latest 32 pictures; also of earlier epochs
  std::uint64_t epoch_ = 0;
  std::optional<double> jump_;  ///< of RTP time, with which the current epoch began, s
};

}  // namespace cartvo::capture
