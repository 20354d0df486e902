#pragma once

#include <cstdint>

#include <gst/rtsp-server/rtsp-server.h>

namespace cartvo::simulate {

/// A GstRTSPMedia whose sender reports carry the instants of exposure: rtpbin relates the RTP time stamp to
/// the buffer's own time (rtcp-sync-send-time off) on the pipeline's clock (ntp-time-source clock-time), and
/// reports come twice a second. Needs `ntpClock` as the pipeline's clock and a base time of 0.
GType cameraMediaType();

/// A clock that shows the time of day as NTP counts it, in ns since 1900 (RFC 3550, 4). The caller owns it.
GstClock* newNtpClock();

/// The time that ntpClock shows at `unix_ns` (ns since the Unix epoch), moved to the 90 kHz grid of RTP time
/// stamps: GStreamer rounds down, so a time just below a tick would lose one.
GstClockTime ntpTimeOnRtpGrid(std::int64_t unix_ns);

}  // namespace cartvo::simulate
