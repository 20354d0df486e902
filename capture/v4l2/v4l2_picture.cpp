// Conversion of V4L2 buffers to grey images.

#include "capture/v4l2/v4l2_picture.hpp"

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "capture/codec/image_completeness.hpp"

namespace cartvo::capture {
namespace {

/// Whether the buffer contains `size` pixels of `bytes_per_pixel`.
bool fits(std::span<const std::uint8_t> buffer, const cv::Size& size, std::size_t stride,
          std::size_t bytes_per_pixel) {
  if (size.width <= 0 || size.height <= 0) return false;
  const std::size_t row = bytes_per_pixel * static_cast<std::size_t>(size.width);
  return stride >= row && buffer.size() >= stride * (static_cast<std::size_t>(size.height) - 1) + row;
}

/// Matrix header for the buffer, which is only read.
cv::Mat view(std::span<const std::uint8_t> buffer, const cv::Size& size, std::size_t stride, int type) {
  return {size, type, const_cast<std::uint8_t*>(buffer.data()), stride};
}

/// Decodes a JPEG. Cameras omit the Huffman tables; libjpeg-turbo uses the standard ones.
cv::Mat decodeJpeg(std::span<const std::uint8_t> buffer, const cv::Size& size) {
  const auto* const characters = reinterpret_cast<const char*>(buffer.data());
  if (buffer.empty() || isCutOffImage({characters, buffer.size()})) return {};
  const cv::Mat bytes(1, static_cast<int>(buffer.size()), CV_8UC1, const_cast<std::uint8_t*>(buffer.data()));
  cv::Mat picture = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
  return picture.size() == size ? picture : cv::Mat();
}

}  // namespace

cv::Mat toGreyImage(PixelFormat format, std::span<const std::uint8_t> buffer, const cv::Size& size,
                    std::size_t stride) {
  cv::Mat grey;
  switch (format) {
    case PixelFormat::grey:
    case PixelFormat::nv12:
      if (fits(buffer, size, stride, 1)) view(buffer, size, stride, CV_8UC1).copyTo(grey);
      break;
    case PixelFormat::yuyv:
      if (fits(buffer, size, stride, 2)) cv::extractChannel(view(buffer, size, stride, CV_8UC2), grey, 0);
      break;
    case PixelFormat::mjpeg:
      return decodeJpeg(buffer, size);
  }
  return grey;
}

}  // namespace cartvo::capture
