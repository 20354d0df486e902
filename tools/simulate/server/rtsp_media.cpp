// Adapts GStreamer's RTSP server so that RTCP sender reports carry exposure instants.
#include "tools/simulate/server/rtsp_media.hpp"

namespace cartvo::simulate {
namespace {

constexpr GstClockTime kFrom1900To1970 = 2'208'988'800ULL * GST_SECOND;  // RFC 868
constexpr std::uint64_t kRtpClockRate = 90'000;                          // RFC 6184, 8.2.1
constexpr guint64 kSenderReportInterval = GST_SECOND / 2;
constexpr int kNtpTimeIsClockTime = 3;  // GST_RTP_NTP_TIME_SOURCE_CLOCK_TIME, not in a public header

void onElementAdded(GstBin* /*rtpbin*/, GstElement* element, gpointer /*unused*/) {
  if (g_object_class_find_property(G_OBJECT_GET_CLASS(element), "rtcp-min-interval") != nullptr) {
    g_object_set(element, "rtcp-min-interval", kSenderReportInterval, nullptr);
  }
}

gboolean setupRtpbin(GstRTSPMedia* /*media*/, GstElement* rtpbin) {
  g_object_set(rtpbin, "rtcp-sync-send-time", FALSE, "ntp-time-source", kNtpTimeIsClockTime, nullptr);
  g_signal_connect(rtpbin, "element-added", G_CALLBACK(onElementAdded), nullptr);
  return TRUE;
}

void initialiseClass(gpointer media_class, gpointer /*unused*/) {
  static_cast<GstRTSPMediaClass*>(media_class)->setup_rtpbin = setupRtpbin;
}

}  // namespace

GType cameraMediaType() {
  static const GType type = g_type_register_static_simple(
      GST_TYPE_RTSP_MEDIA, "CartvoCameraMedia", sizeof(GstRTSPMediaClass), initialiseClass,
      sizeof(GstRTSPMedia), nullptr, static_cast<GTypeFlags>(0));
  return type;
}

GstClock* newNtpClock() {
  auto* clock = static_cast<GstClock*>(g_object_new(GST_TYPE_SYSTEM_CLOCK, "name", "cartvo-ntp-clock",
                                                    "clock-type", GST_CLOCK_TYPE_REALTIME, nullptr));
  gst_object_ref_sink(clock);
  gst_clock_set_calibration(clock, 0, kFrom1900To1970, 1, 1);
  return clock;
}

GstClockTime ntpTimeOnRtpGrid(std::int64_t unix_ns) {
  const GstClockTime time = static_cast<GstClockTime>(unix_ns) + kFrom1900To1970;
  const guint64 ticks = gst_util_uint64_scale_round(time, kRtpClockRate, GST_SECOND);
  return gst_util_uint64_scale_ceil(ticks, GST_SECOND, kRtpClockRate);
}

}  // namespace cartvo::simulate
