#pragma once

#include <cstdint>
#include <memory>

#include <opencv2/core/mat.hpp>

// Decoded image of one camera with its time stamps.

namespace cartvo::capture {

/// Whether a frame's picture is intact.
enum class FrameStatus : std::uint8_t {
  good,
  damaged,  ///< data were lost since the last refresh, or its RTP time cannot be: do not use it
};

/// Source of a frame's instant of exposure: in the order of camera_health_t's constants.
enum class InstantSource : std::uint8_t {
  file,           ///< written beside the images
  sender_report,  ///< RTP time related to the camera's clock by RTCP sender reports (RFC 3550, 6.4.1)
  arrival,        ///< RTP time related to the host's clock by the fastest arrivals
  pictures,       ///< as arrival, and the two cameras related to each other by their image content
  kernel,         ///< stamped by this host's kernel, both cameras by one clock
};

/// Default standard deviation of one camera's instants against the other's, ns. Two clocks that follow an NTP
/// server in the same network agree to about 1 ms; arrivals differ by the encoding and transmission times of
/// pictures of different size.
constexpr std::int64_t defaultStddevNs(InstantSource source) {
  switch (source) {
    case InstantSource::file:
      return 0;
    case InstantSource::sender_report:
    case InstantSource::pictures:
    case InstantSource::kernel:
      return 1'000'000;
    case InstantSource::arrival:
      return 5'000'000;
  }
  return 5'000'000;
}

/// When a picture was exposed, and how that is known. All instants: ns since the Unix epoch.
struct ExposureInstant {
  std::int64_t exposure_ns = 0;  ///< live cameras: by the host's clock, see StereoTimestamper
  /// Standard deviation of exposure_ns: 1/sqrt(2) of that of right minus left exposure.
  std::int64_t exposure_stddev_ns = 0;
  /// Part of exposure_ns that corrections of the clock models have added: exposure_ns - slew_ns advances by
  /// the camera's own clock from picture to picture, also where exposure_ns is being corrected.
  std::int64_t slew_ns = 0;
  std::int64_t min_delay_arrival_ns = 0;  ///< live cameras: arrival at the least network delay; else 0
  InstantSource instant_source = InstantSource::arrival;
};

/// Time stamps and numbers of a picture, from the camera to the estimate.
struct FrameTimestamps : ExposureInstant {
  std::int64_t arrival_ns = 0;  ///< reception of the frame's last packet, host's clock
  std::int64_t decoded_ns = 0;  ///< end of decoding, host's clock; 0 before
  std::uint64_t sequence = 0;  ///< counts the camera's frames from 0, including lost ones where that is known
  std::uint64_t order = 0;     ///< recordings: counts both cameras' frames from 1 in order of arrival; else 0
};

/// One image of one camera with its time stamps.
struct Frame : FrameTimestamps {
  cv::Mat image;  ///< CV_8UC1, grey; may lie in memory that `storage` keeps alive; read-only
  FrameStatus status = FrameStatus::good;
  bool key_frame =
      false;  ///< video: the picture is intra-coded, not predicted from another (see CodecErrorModel)
  std::shared_ptr<const void> storage;  ///< owner of the image's memory, or empty if `image` owns it
};

}  // namespace cartvo::capture
