#pragma once

#include <cstdint>
#include <memory>

#include <opencv2/core/mat.hpp>

namespace cartvo {

/// Whether a frame's picture can be trusted.
enum class FrameStatus : std::uint8_t {
  good,
  damaged,  ///< data were lost since the last key frame: never match features in it
};

/// Where a frame's exposure instant comes from.
enum class InstantSource : std::uint8_t {
  file,           ///< written beside the images
  sender_report,  ///< RTP time related to the camera's clock by RTCP sender reports (RFC 3550, 6.4.1)
  arrival,        ///< RTP time related to the host's clock by the quickest arrivals
  pictures,       ///< as arrival, and the two cameras to each other by what both see
  kernel,         ///< stamped by this host's kernel, both cameras by one clock
};

/// Standard deviation of a camera's instants against another's, ns, where nothing better is known of them.
/// Two clocks that follow a time server in the same network agree to about a millisecond; arrival differs by
/// what encoding and network make of pictures of different size.
constexpr std::int64_t usualDeviationNs(InstantSource source) {
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

/// One image of one camera with the instants that belong to it. All instants: ns since the Unix epoch.
struct Frame {
  cv::Mat image;                 ///< CV_8UC1, grey; may lie in memory that `storage` keeps alive; read-only
  std::int64_t exposure_ns = 0;  ///< of live cameras: by the host's clock, as PairClock relates the two
  std::int64_t exposure_deviation_ns = 0;  ///< standard deviation of exposure_ns
  std::int64_t undelayed_arrival_ns = 0;   ///< of live cameras: see StampedInstant; else 0
  std::int64_t arrival_ns = 0;             ///< the frame's last packet was received (host's clock)
  std::int64_t decoded_ns = 0;             ///< the picture was ready (host's clock)
  std::uint64_t sequence = 0;  ///< counts the camera's frames from 0, lost ones included where that is known
  std::uint64_t order = 0;     ///< of recordings: counts both cameras' frames from 1 as they came; else 0
  FrameStatus status = FrameStatus::good;
  /// Of a video: its picture is coded by itself, not as a change of the one before (see VideoErrors).
  bool key_frame = false;
  InstantSource instant_source = InstantSource::file;
  std::shared_ptr<const void> storage;  ///< owner of the image's memory, or empty if `image` owns it
};

}  // namespace cartvo
