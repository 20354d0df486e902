#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <opencv2/core/mat.hpp>

// Pixel formats of V4L2 cameras and their conversion to grey images.

namespace cartvo::capture {

/// Pixel format of a V4L2 camera (linux/videodev2.h, V4L2_PIX_FMT_...).
enum class PixelFormat : std::uint8_t {
  grey,   ///< one byte per pixel
  nv12,   ///< luma plane, then interleaved chroma
  yuyv,   ///< two bytes per pixel, the first is luma
  mjpeg,  ///< one JPEG per picture
};

/// Name of the format in capitals, as in the configuration.
constexpr const char* formatName(PixelFormat format) {
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

/// Converts a buffer to a grey image, CV_8UC1, with memory of its own. `size` in px; `stride`: bytes from row
/// to row (ignored for MJPEG). Empty if the buffer is too short, or if a JPEG is cut off, cannot be decoded
/// or has another size.
cv::Mat toGreyImage(PixelFormat format, std::span<const std::uint8_t> buffer, const cv::Size& size,
                    std::size_t stride);

}  // namespace cartvo::capture
