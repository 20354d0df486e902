// Luma plane of a decoded FFmpeg frame.

#include "capture/codec/luma_plane.hpp"

#include <array>
#include <cstdint>
#include <memory>

extern "C" {
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>
}

namespace cartvo::capture {

cv::Mat lumaPlane(const AVFrame& frame) {
  const AVPixFmtDescriptor* format = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
  constexpr std::uint64_t kNoLuma = AV_PIX_FMT_FLAG_RGB | AV_PIX_FMT_FLAG_HWACCEL | AV_PIX_FMT_FLAG_PAL |
                                    AV_PIX_FMT_FLAG_BITSTREAM | AV_PIX_FMT_FLAG_BE;
  if (format == nullptr || (format->flags & kNoLuma) != 0) return {};
  const AVComponentDescriptor& luma = format->comp[0];
  if (luma.plane != 0 || luma.offset != 0) return {};
  const auto stride = static_cast<std::size_t>(frame.linesize[0]);
  if (luma.step == 1 && luma.depth == 8) return {frame.height, frame.width, CV_8UC1, frame.data[0], stride};
  if (luma.step != 2 || luma.depth < 9 || luma.depth > 16) return {};
  const cv::Mat deep(frame.height, frame.width, CV_16UC1, frame.data[0], stride);
  cv::Mat grey;
  deep.convertTo(grey, CV_8UC1, 1.0 / static_cast<double>(1U << (luma.depth - 8 + luma.shift)));
  return grey;
}

cv::Mat greyPicture(const AVFrame& frame) {
  if (cv::Mat luma = lumaPlane(frame); !luma.empty()) return luma;
  const std::unique_ptr<SwsContext, decltype(&sws_freeContext)> context(
      sws_getContext(frame.width, frame.height, static_cast<AVPixelFormat>(frame.format), frame.width,
                     frame.height, AV_PIX_FMT_GRAY8, SWS_POINT, nullptr, nullptr, nullptr),
      sws_freeContext);
  if (!context) return {};
  cv::Mat grey(frame.height, frame.width, CV_8UC1);
  const std::array<std::uint8_t*, 1> planes{grey.data};
  const std::array<int, 1> strides{static_cast<int>(grey.step)};
  const int rows =
      sws_scale(context.get(), frame.data, frame.linesize, 0, frame.height, planes.data(), strides.data());
  return rows == frame.height ? grey : cv::Mat();
}

}  // namespace cartvo::capture
