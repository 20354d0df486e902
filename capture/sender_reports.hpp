#pragma once

#include <cstdint>
#include <optional>

namespace cartvo {

/// Finds the RTCP sender reports (RFC 3550, 6.4.1) in what FFmpeg makes of them: the instant of each picture
/// by the last one. Pure.
///
/// FFmpeg 5.1 relates a packet to the last report with a 32-bit difference that it does not wrap: once the
/// RTP clock wraps (each 13.3 h) its instants are 2^32/90000 s = 47,721.9 s off until the next report. RTP
/// time stamps themselves are unwrapped rightly, so a jump of that size in the relation of the two is undone.
class SenderReports {
 public:
  /// `rtp_us`: the picture's RTP time, unwrapped; `reference_us`: its instant as FFmpeg computes it, us since
  /// the Unix epoch; `expected_us`: where it is expected, roughly. Returns the picture's instant if a report
  /// has come since the last call, or a long time has passed and the last one still holds.
  std::optional<std::int64_t> next(std::int64_t rtp_us, std::int64_t reference_us, std::int64_t expected_us);

 private:
  std::int64_t wholeWraps(std::int64_t difference_us);

  std::optional<std::int64_t> last_reported_us_;  ///< instant minus RTP time, as it was last reported
  std::int64_t last_rtp_us_ = 0;
  int corrected_reports_ = 0;  ///< reports in a row that agree only after a wrap is undone
};

}  // namespace cartvo
