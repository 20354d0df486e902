#pragma once

#include <cstdint>
#include <optional>

#include "capture/arrival_line.hpp"
#include "capture/report_line.hpp"
#include "capture/sender_reports.hpp"

namespace cartvo {

/// What one picture's packets tell of when it was exposed.
struct StampedPacket {
  std::int64_t pts = 0;                      ///< RTP time stamp, 1/90000 s; 32 bits of it are enough
  std::optional<std::int64_t> reference_us;  ///< its instant by the last sender report, as FFmpeg computes it
  std::int64_t arrival_ns = 0;               ///< of the picture's first packet, host's clock
};

/// One camera's clocks: its RTP time against the host's clock, by arrival, and against the camera's own, by
/// its sender reports. Pure.
///
/// The RTP clock is a crystal's, exact from picture to picture. Against the host's it is known to some 0.1 ms
/// by the quickest arrivals, but for the camera's latency, which no arrival tells. Reports tell the instant
/// without latency, but by the camera's idea of the time, and with the noise of what stamps them.
class StreamClock {
 public:
  /// `usual_scatter_ns`: as ReportLine's.
  explicit StreamClock(double usual_scatter_ns)
      : usual_scatter_ns_(usual_scatter_ns), reports_(usual_scatter_ns) {}

  /// A new connection: RTP time begins anew.
  void connect();

  void add(const StampedPacket& packet);

  /// How long this connection has lasted, s of RTP time.
  double seconds() const { return static_cast<double>(rtp_ns_ - first_rtp_ns_.value_or(rtp_ns_)) * 1e-9; }

  /// RTP time of the last picture, ns, continued over wraps.
  std::int64_t rtpNs() const { return rtp_ns_; }

  /// When the last picture would have arrived had nothing held it up, host's clock. After `add`.
  std::int64_t undelayedArrivalNs() const { return arrivals_.at(rtp_ns_); }
  const ArrivalLine& arrivals() const { return arrivals_; }

  /// Exposure of the last picture by the camera's clock; nothing before the first report.
  std::optional<std::int64_t> reportedNs() const;
  double reportedDeviationNs() const { return reports_.deviationNs(rtp_ns_); }
  const ReportLine& reports() const { return reports_; }

  /// From exposure to undelayed arrival, by both clocks, ns; nothing while it is not known to some 10 ms.
  std::optional<std::int64_t> latencyNs() const;

 private:
  std::int64_t unwrapped(std::int64_t pts);

  double usual_scatter_ns_;
  ArrivalLine arrivals_;
  ReportLine reports_;
  SenderReports sender_reports_;
  std::optional<std::int64_t> last_pts_;
  std::optional<std::int64_t> first_rtp_ns_;
  std::int64_t rtp_ns_ = 0;
};

}  // namespace cartvo
