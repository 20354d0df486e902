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

#include "capture/v4l2_picture.hpp"

// Not for use outside V4l2Camera.

namespace cartvo {

/// What is wanted of a camera before it streams.
struct V4l2Mode {
  cv::Size size;                      ///< px
  double frame_rate = 18.0;           ///< Hz
  std::optional<PixelFormat> format;  ///< nothing: the first of GREY, NV12, YUYV, MJPEG that it offers
  std::optional<double> exposure;     ///< s; nothing: as the camera is set
  std::optional<int> gain;            ///< in the driver's unit; nothing: as the camera is set
};

/// A camera that cannot be used, or no longer; the message names it and says what to do.
class V4l2Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One picture in the driver's memory; given back when the next one is asked for.
struct V4l2Buffer {
  std::span<const std::uint8_t> data;
  std::chrono::nanoseconds monotonic{};  ///< kernel's time stamp, CLOCK_MONOTONIC
  std::uint32_t sequence = 0;            ///< the driver's count of pictures, lost ones included
  bool damaged = false;                  ///< the driver says that data are missing
};

/// A camera of the Linux kernel's Video4Linux2, streaming from its opening on through buffers that the kernel
/// shares (memory-mapped streaming).
class V4l2Device {
 public:
  /// Throws V4l2Error if there is no such camera, or if it does not do what is wanted.
  V4l2Device(const std::filesystem::path& device, const V4l2Mode& mode);
  ~V4l2Device();
  V4l2Device(const V4l2Device&) = delete;
  V4l2Device& operator=(const V4l2Device&) = delete;

  /// Waits for the next picture until `deadline`, or until `interrupt`, a file descriptor, can be read;
  /// nothing then. Throws V4l2Error when the camera is gone.
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
  void checkCapabilities() const;
  void chooseFormat(const V4l2Mode& mode);
  void setFrameRate(double frame_rate) const;
  void setControls(const V4l2Mode& mode) const;
  void setControl(std::uint32_t id, std::int32_t value, const std::string& key) const;
  bool hasControl(std::uint32_t id) const;
  void mapBuffers();
  void enqueue(std::uint32_t index) const;
  void close() noexcept;

  std::filesystem::path device_;
  int descriptor_ = -1;
  PixelFormat format_ = PixelFormat::grey;
  std::size_t stride_ = 0;
  std::vector<Mapping> buffers_;
  std::optional<std::uint32_t> lent_;  ///< the buffer that was handed out
};

}  // namespace cartvo
