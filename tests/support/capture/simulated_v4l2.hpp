#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <vector>

// A V4L2 device for tests: the executable's ioctl() answers the requests about a file that a test names.

namespace cartvo::test {

class SimulatedV4l2 {
 public:
  static constexpr std::uint32_t kBufferBytes = 1U << 16U;

  /// Makes `device` a camera as long as this object exists. One camera exists at a time.
  explicit SimulatedV4l2(std::filesystem::path device);
  ~SimulatedV4l2();
  SimulatedV4l2(const SimulatedV4l2&) = delete;
  SimulatedV4l2& operator=(const SimulatedV4l2&) = delete;

  /// Fills the buffer that is queued next. For a device without planes, `offset` is 0.
  void send(std::span<const std::uint8_t> picture, std::uint32_t sequence, std::uint32_t offset = 0);

  /// The request's result, as by ioctl: 0, or an error number.
  int answer(unsigned long request, void* argument);

  const std::filesystem::path device;
  std::uint32_t capabilities, format;
  std::uint32_t planes = 0;             ///< 0: the interface without planes
  std::uint32_t width = 6, height = 4;  ///< of the only size
  std::map<unsigned long, int> errors;  ///< by request: the error number that it fails with

 private:
  int requestFormat(void* argument) const;
  int describeBuffer(void* argument) const;
  int queueBuffer(void* argument);
  int returnBuffer(void* argument);

  struct Picture {
    std::uint32_t sequence, begin, end, index;
  };
  std::vector<std::uint32_t> queued_;
  std::vector<Picture> pictures_;
};

}  // namespace cartvo::test
