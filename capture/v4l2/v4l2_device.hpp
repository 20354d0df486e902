#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include <opencv2/core/types.hpp>

#include "capture/v4l2/v4l2_picture.hpp"

// An open Video4Linux2 device with its buffers. Internal to V4l2Camera.

namespace cartvo::capture {

/// Requested configuration of a camera.
struct V4l2Mode {
  cv::Size size;                      ///< px
  double frame_rate = 18.0;           ///< Hz
  std::optional<PixelFormat> format;  ///< nothing: the first of GREY, NV12, YUYV, MJPEG that it offers
  std::optional<double> exposure;     ///< exposure time, s; nothing: unchanged
  std::optional<int> gain;            ///< in the driver's unit; nothing: unchanged
};

/// Error of a camera that cannot be used (any more). The message names the camera and what to do.
class V4l2Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One picture in the driver's memory; returned to the driver by the next call of `dequeue`.
struct V4l2Buffer {
  std::span<const std::uint8_t> data;
  std::chrono::nanoseconds monotonic{};  ///< kernel's time stamp, CLOCK_MONOTONIC
  std::uint32_t sequence = 0;            ///< the driver's count of pictures, including lost ones
  bool damaged = false;                  ///< the driver reports missing data
};

/// A Video4Linux2 device that streams through memory-mapped buffers as long as it is open.
class V4l2Device {
 public:
  /// Opens the device and starts streaming. Throws V4l2Error if it does not exist or does not support `mode`.
  V4l2Device(const std::filesystem::path& device, const V4l2Mode& mode);
  ~V4l2Device();
  V4l2Device(const V4l2Device&) = delete;
  V4l2Device& operator=(const V4l2Device&) = delete;

  /// Waits for the next picture. Nothing at `deadline`, or when the file descriptor `interrupt` becomes
  /// readable. Throws V4l2Error if the camera was disconnected.
  std::optional<V4l2Buffer> dequeue(std::chrono::steady_clock::time_point deadline, int interrupt);

  PixelFormat format() const { return format_; }
  std::size_t stride() const { return stride_; }  ///< bytes from row to row

 private:
  struct Mapping {
    void* address = nullptr;
    std::size_t length = 0;
  };

  [[noreturn]] void fail(const std::string& what) const;
  [[noreturn]] void failWithErrno(const std::string& what) const;
  void checkCapabilities();
  void selectFormat(const V4l2Mode& mode);
  cv::Size requestFormat(std::uint32_t code, const cv::Size& size);
  void setFrameRate(double frame_rate) const;
  void setControls(const V4l2Mode& mode) const;
  void setControl(std::uint32_t id, std::int32_t value, const std::string& key) const;
  bool hasControl(std::uint32_t id) const;
  void mapBuffers();
  void enqueue(std::uint32_t index) const;
  void close() noexcept;

  std::filesystem::path device_;
  int descriptor_ = -1;
  std::uint32_t type_ = 1;  ///< of the buffers: V4L2_BUF_TYPE_VIDEO_CAPTURE, or ..._MPLANE
  PixelFormat format_ = PixelFormat::grey;
  std::size_t stride_ = 0;
  std::vector<Mapping> buffers_;
  std::optional<std::uint32_t> dequeued_;  ///< index of the buffer that the caller is using
};

}  // namespace cartvo::capture
