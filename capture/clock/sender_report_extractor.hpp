#pragma once

#include <cstdint>
#include <optional>

namespace cartvo::capture {

/// Extracts RTCP sender reports (RFC 3550, 6.4.1) from the instant of each picture by the last report, which
/// is what recordings hold. Reads no clock; deterministic.
///
/// Corrects a fault of FFmpeg 5.1, by which recordings made before RtspSession's own client were received: it
/// relates a packet to the last report with a 32-bit difference that it
/// does not wrap. After a wrap of the RTP clock (every 13.3 h) its instants are 2^32/90000 s = 47,721.9 s off
/// until the next report. FFmpeg unwraps the RTP time stamps themselves correctly, so a jump of that size in
/// the difference of the two is undone.
class SenderReportExtractor {
 public:
  /// `rtp_us`: the picture's RTP time, unwrapped; `reference_us`: its instant by the last report, us since
  /// the Unix epoch; `expected_us`: its approximate instant. Returns the corrected instant, us since the Unix
  /// epoch, if there was a new report since the last call, or the last one has been valid for 10 s.
  std::optional<std::int64_t> extract(std::int64_t rtp_us, std::int64_t reference_us,
                                      std::int64_t expected_us);

 private:
  std::int64_t missingWraps(std::int64_t difference_us);

  std::optional<std::int64_t> last_offset_us_;  ///< instant minus RTP time by the last report
  std::int64_t last_rtp_us_ = 0;
  int corrected_reports_ = 0;  ///< consecutive reports that agree only after a wrap is undone
};

}  // namespace cartvo::capture
