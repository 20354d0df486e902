#pragma once

#include <cstdint>
#include <optional>

#include "capture/frame.hpp"

namespace cartvo {

/// Gives each picture of one connection its exposure instant, from its RTP time stamp and what the camera's
/// sender reports say (RFC 3550, 6.4.1). Pure. A first version: each report is taken at its word.
///
/// FFmpeg 5.1 relates a packet to the last report with a 32-bit difference that it does not wrap: once the
/// RTP clock wraps (each 13.3 h) its instants are 2^32/90000 s = 47,721.9 s off until the next report. RTP
/// time stamps themselves are unwrapped rightly, so a jump of that size in the relation of the two is undone.
class ExposureClock {
 public:
  struct Instant {
    std::int64_t exposure_ns = 0;
    InstantSource source = InstantSource::arrival;
    std::int64_t deviation_ns = usualDeviationNs(InstantSource::arrival);
  };

  /// `pts`: unwrapped RTP time stamp, 1/90000 s. `reference_us`: the same instant by the last sender report
  /// as FFmpeg computes it, us since the Unix epoch; none before the first report. `arrival_ns` stands in
  /// then.
  Instant stamp(std::int64_t pts, std::optional<std::int64_t> reference_us, std::int64_t arrival_ns);

 private:
  void update(std::int64_t relation_us, std::int64_t arrival_relation_us);

  std::optional<std::int64_t> relation_us_;       ///< instant minus RTP time, as given out
  std::optional<std::int64_t> last_reported_us_;  ///< the same, as it was last reported
  std::int64_t correction_us_ = 0;                ///< whole wraps added to what is reported
  int corrected_reports_ = 0;  ///< reports in a row that agreed only after a wrap was undone
};

}  // namespace cartvo
