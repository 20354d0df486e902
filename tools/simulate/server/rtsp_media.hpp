#pragma once

#include <cstdint>

#include <gst/rtsp-server/rtsp-server.h>

namespace cartvo::simulate {

/// Type of a GstRTSPMedia whose sender reports carry the exposure instants: rtpbin relates the RTP timestamp
/// to the buffer's own time (rtcp-sync-send-time off) on the pipeline's clock (ntp-time-source clock-time).
/// Reports are sent twice a second. The pipeline must use newNtpClock() and a base time of 0.
GType cameraMediaType();

/// A clock of NTP time, ns since 1900 (RFC 3550, section 4). The caller owns it.
GstClock* newNtpClock();

/// NTP time of `unix_ns` (ns since the Unix epoch), rounded to the 90 kHz grid of RTP timestamps: GStreamer
/// rounds down, so a time just below a tick would lose one.
GstClockTime ntpTimeOnRtpGrid(std::int64_t unix_ns);

}  // namespace cartvo::simulate
