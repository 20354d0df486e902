#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <opencv2/core/mat.hpp>

namespace cartvo {

/// How a V4L2 camera hands its pictures over (linux/videodev2.h, V4L2_PIX_FMT_...).
enum class PixelFormat : std::uint8_t {
  grey,   ///< one byte a pixel
  nv12,   ///< a plane of grey, then colours
  yuyv,   ///< two bytes a pixel, the first is grey
  mjpeg,  ///< a JPEG a picture
};

constexpr const char* nameOf(PixelFormat format) {
  switch (format) {
    case PixelFormat::grey:
      return "GREY";
    case PixelFormat::nv12:
      return "NV12";
    case PixelFormat::yuyv:
      return "YUYV";
    case PixelFormat::mjpeg:
      return "MJPEG";
  }
  return "";
}

/// The grey picture in a buffer, CV_8UC1 with memory of its own: `size` pixels, rows `stride` bytes apart (of
/// MJPEG neither is used but to check the picture). Empty if the buffer is too short for it, or if it is a
/// JPEG that cannot be decoded or has another size.
cv::Mat greyPicture(PixelFormat format, std::span<const std::uint8_t> buffer, const cv::Size& size,
                    std::size_t stride);

}  // namespace cartvo
