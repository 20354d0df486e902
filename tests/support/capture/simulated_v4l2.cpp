// ioctl() of the test executable, which answers for a simulated camera and hands all else to the kernel.
#include "support/capture/simulated_v4l2.hpp"

#include <cerrno>
#include <cstdarg>
#include <fstream>
#include <utility>

#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace cartvo::test {
namespace {

SimulatedV4l2* simulated_camera = nullptr;

bool isSimulated(int descriptor) {
  struct stat opened {};
  struct stat named {};
  return simulated_camera != nullptr && ::fstat(descriptor, &opened) == 0 &&
         ::stat(simulated_camera->device.c_str(), &named) == 0 && opened.st_dev == named.st_dev &&
         opened.st_ino == named.st_ino;
}

}  // namespace

SimulatedV4l2::SimulatedV4l2(std::filesystem::path file)
    : device(std::move(file)),
      capabilities(V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING),
      format(V4L2_PIX_FMT_GREY) {
  std::ofstream(device, std::ios::binary);
  std::filesystem::resize_file(device, 4 * kBufferBytes);
  simulated_camera = this;
}

SimulatedV4l2::~SimulatedV4l2() {
  simulated_camera = nullptr;
}

void SimulatedV4l2::send(std::span<const std::uint8_t> picture, std::uint32_t sequence,
                         std::uint32_t offset) {
  const std::uint32_t index = queued_.at(0);
  queued_.erase(queued_.begin());
  std::fstream memory(device, std::ios::in | std::ios::out | std::ios::binary);
  memory.seekp(static_cast<std::streamoff>(index) * kBufferBytes + offset);
  memory.write(reinterpret_cast<const char*>(picture.data()), static_cast<std::streamsize>(picture.size()));
  pictures_.push_back({sequence, offset, offset + static_cast<std::uint32_t>(picture.size()), index});
}

int SimulatedV4l2::requestFormat(void* argument) const {
  auto& wanted = *static_cast<v4l2_format*>(argument);
  if (planes == 0) {
    wanted.fmt.pix.width = width, wanted.fmt.pix.height = height, wanted.fmt.pix.pixelformat = format;
    wanted.fmt.pix.bytesperline = width;
  } else {
    wanted.fmt.pix_mp.width = width, wanted.fmt.pix_mp.height = height;
    wanted.fmt.pix_mp.pixelformat = format;
    wanted.fmt.pix_mp.num_planes = static_cast<std::uint8_t>(planes);
    wanted.fmt.pix_mp.plane_fmt[0].bytesperline = width;
  }
  return 0;
}

int SimulatedV4l2::describeBuffer(void* argument) const {
  auto& buffer = *static_cast<v4l2_buffer*>(argument);
  if (planes == 0) {
    buffer.length = kBufferBytes;
    buffer.m.offset = buffer.index * kBufferBytes;
  } else if (buffer.length < planes) {
    return EINVAL;
  } else {
    for (std::uint32_t plane = 0; plane < planes; ++plane)
      buffer.m.planes[plane].length = kBufferBytes;
    buffer.m.planes[0].m.mem_offset = buffer.index * kBufferBytes;
  }
  return 0;
}

int SimulatedV4l2::queueBuffer(void* argument) {
  const auto& buffer = *static_cast<const v4l2_buffer*>(argument);
  if (planes > 0 && buffer.length < planes) return EINVAL;
  queued_.push_back(buffer.index);
  return 0;
}

int SimulatedV4l2::returnBuffer(void* argument) {
  if (pictures_.empty()) return ENODEV;
  const Picture picture = pictures_.front();
  pictures_.erase(pictures_.begin());
  auto& buffer = *static_cast<v4l2_buffer*>(argument);
  buffer.index = picture.index;
  buffer.sequence = picture.sequence;
  buffer.flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  if (planes == 0) {
    buffer.bytesused = picture.end;
  } else {
    buffer.m.planes[0].data_offset = picture.begin;
    buffer.m.planes[0].bytesused = picture.end;
  }
  return 0;
}

int SimulatedV4l2::answer(unsigned long request, void* argument) {
  if (const auto error = errors.find(request); error != errors.end()) return error->second;
  const std::uint32_t wanted_type =
      planes == 0 ? V4L2_BUF_TYPE_VIDEO_CAPTURE : V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
  switch (request) {
    case VIDIOC_QUERYCAP:
      static_cast<v4l2_capability*>(argument)->capabilities = capabilities;
      return 0;
    case VIDIOC_ENUM_FMT: {
      auto& description = *static_cast<v4l2_fmtdesc*>(argument);
      if (description.type != wanted_type || description.index > 0) return EINVAL;
      description.pixelformat = format;
      return 0;
    }
    case VIDIOC_S_FMT:
      return static_cast<v4l2_format*>(argument)->type == wanted_type ? requestFormat(argument) : EINVAL;
    case VIDIOC_REQBUFS:
      queued_.clear();
      return static_cast<v4l2_requestbuffers*>(argument)->type == wanted_type ? 0 : EINVAL;
    case VIDIOC_QUERYBUF:
      return describeBuffer(argument);
    case VIDIOC_QBUF:
      return queueBuffer(argument);
    case VIDIOC_STREAMON:
    case VIDIOC_STREAMOFF:
      return *static_cast<std::uint32_t*>(argument) == wanted_type ? 0 : EINVAL;
    case VIDIOC_DQBUF:
      return returnBuffer(argument);
    default:
      return ENOTTY;
  }
}

}  // namespace cartvo::test

extern "C" int ioctl(int descriptor, unsigned long request, ...) noexcept {
  va_list arguments;
  va_start(arguments, request);
  void* const argument = va_arg(arguments, void*);
  va_end(arguments);
  if (!cartvo::test::isSimulated(descriptor))
    return static_cast<int>(::syscall(SYS_ioctl, descriptor, request, argument));
  const int error = cartvo::test::simulated_camera->answer(request, argument);
  if (error == 0) return 0;
  errno = error;
  return -1;
}
