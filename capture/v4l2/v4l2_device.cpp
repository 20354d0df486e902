// Memory-mapped streaming through the kernel's Video4Linux2 interface (docs.kernel.org, "Video for Linux
// API").

#include "capture/v4l2/v4l2_device.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "common/exact_text.hpp"
#include "common/printable_text.hpp"

namespace cartvo::capture {
namespace {

constexpr std::uint32_t kBufferCount = 4;
constexpr double kRateTolerance = 0.01;    // relative
constexpr double kExposureUnit = 100e-6;   // s, of V4L2_CID_EXPOSURE_ABSOLUTE
constexpr std::uint32_t kMaxFormats = 64;  // limit of the enumeration

/// In order of increasing decoding cost.
constexpr std::array<std::pair<PixelFormat, std::uint32_t>, 5> kFormats{
    {{PixelFormat::grey, V4L2_PIX_FMT_GREY},
     {PixelFormat::nv12, V4L2_PIX_FMT_NV12},
     {PixelFormat::nv12, V4L2_PIX_FMT_NV12M},
     {PixelFormat::yuyv, V4L2_PIX_FMT_YUYV},
     {PixelFormat::mjpeg, V4L2_PIX_FMT_MJPEG}}};

/// Cause and remedy of an error number that drivers of cameras return.
struct ErrnoHint {
  int error;
  const char* cause;  ///< in place of the system's text; nullptr: that text is right
  const char* remedy;
};
constexpr const char* kPluggedIn = "is it plugged in? 'v4l2-ctl --list-devices' names all";
constexpr const char* kDenied = "the user needs the group 'video', a service DeviceAllow=, see cartvod(8)";
constexpr const char* kPipeline =
    "'media-ctl -p' shows the sensor, its links and their formats; set them first";
constexpr const char* kNoAnswer = "check its cable, hub and power; 'dmesg' shows the driver's reason";
constexpr std::array kErrnoHints{
    ErrnoHint{ENOENT, nullptr, kPluggedIn},
    ErrnoHint{ENODEV, nullptr, kPluggedIn},
    ErrnoHint{ENXIO, nullptr, kPluggedIn},
    ErrnoHint{EACCES, nullptr, kDenied},
    ErrnoHint{EPERM, nullptr, kDenied},
    ErrnoHint{EBUSY, nullptr, "another program uses it, 'fuser -v /dev/video*' shows which one"},
    ErrnoHint{
        ENOSPC, "the USB bus has too little bandwidth left for this camera",
        "connect the cameras to different USB controllers ('lsusb -t'), or set 'format: MJPEG', a lower "
        "cameras.frame_rate or a smaller size"},
    ErrnoHint{ENOMEM, nullptr,
              "the kernel has no memory for its buffers; a smaller size needs less, 'cma=' reserves more"},
    ErrnoHint{EPIPE, "the parts of its media pipeline do not fit together", kPipeline},
    ErrnoHint{ENOLINK, "its media pipeline is not linked to a sensor", kPipeline},
    ErrnoHint{EIO, nullptr, kNoAnswer},
    ErrnoHint{EPROTO, nullptr, kNoAnswer},
    ErrnoHint{EILSEQ, nullptr, kNoAnswer},
    ErrnoHint{EREMOTEIO, nullptr, kNoAnswer},
    ErrnoHint{ETIMEDOUT, nullptr, kNoAnswer}};

std::string describeErrno(int error) {
  const auto* const hint = std::find_if(kErrnoHints.begin(), kErrnoHints.end(),
                                        [error](auto& known) { return known.error == error; });
  if (hint == kErrnoHints.end()) return std::strerror(error);
  return std::string(hint->cause != nullptr ? hint->cause : std::strerror(error)) + "; " + hint->remedy;
}

/// ioctl, repeated if a signal interrupted it.
int xioctl(int descriptor, unsigned long request, void* argument) {
  int result = 0;
  do
    result = ioctl(descriptor, request, argument);
  while (result < 0 && errno == EINTR);
  return result;
}

std::string toText(const cv::Size& size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

/// A format's four characters, such as "RG10" of a raw Bayer sensor.
std::string formatCode(std::uint32_t code) {
  std::string text;
  for (int shift = 0; shift < 32; shift += 8)
    text += static_cast<char>(code >> shift & 0x7FU);  // the uppermost bit states the order of bytes
  return printableExcerpt(text);
}

std::vector<std::uint32_t> offeredFormats(int descriptor, std::uint32_t type) {
  std::vector<std::uint32_t> formats;
  for (std::uint32_t index = 0; index < kMaxFormats; ++index) {
    v4l2_fmtdesc description{};
    description.index = index;
    description.type = type;
    if (xioctl(descriptor, VIDIOC_ENUM_FMT, &description) < 0) break;
    formats.push_back(description.pixelformat);
  }
  return formats;
}

int millisecondsUntil(std::chrono::steady_clock::time_point deadline) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
  return static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, 60'000));
}

/// Argument of the requests about a buffer. Of a multi-planar device, the first plane has the luma.
struct BufferRequest {
  v4l2_buffer buffer{};
  std::array<v4l2_plane, VIDEO_MAX_PLANES> planes{};
  bool is_planar;

  BufferRequest(std::uint32_t type, std::uint32_t index)
      : is_planar(type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE) {
    buffer.type = type;
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.index = index;
    if (!is_planar) return;
    buffer.m.planes = planes.data();
    buffer.length = static_cast<std::uint32_t>(planes.size());
  }
  std::size_t length() const { return is_planar ? planes[0].length : buffer.length; }
  std::uint32_t offset() const { return is_planar ? planes[0].m.mem_offset : buffer.m.offset; }
  std::size_t begin() const { return is_planar ? planes[0].data_offset : 0; }
  std::size_t end() const { return is_planar ? planes[0].bytesused : buffer.bytesused; }
};

}  // namespace

V4l2Device::V4l2Device(const std::filesystem::path& device, const V4l2Mode& mode) : device_(device) {
  descriptor_ = open(device.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (descriptor_ < 0) failWithErrno("cannot be opened");
  try {
    checkCapabilities();
    selectFormat(mode);
    setFrameRate(mode.frame_rate);
    setControls(mode);
    mapBuffers();
    if (xioctl(descriptor_, VIDIOC_STREAMON, &type_) < 0) failWithErrno("does not start streaming");
  } catch (...) {
    close();
    throw;
  }
}

V4l2Device::~V4l2Device() {
  close();
}

void V4l2Device::close() noexcept {
  xioctl(descriptor_, VIDIOC_STREAMOFF, &type_);
  for (const Mapping& buffer : buffers_)
    munmap(buffer.address, buffer.length);
  buffers_.clear();
  ::close(descriptor_);
}

void V4l2Device::fail(const std::string& what) const {
  throw V4l2Error("the camera " + device_.string() + " " + what);
}

void V4l2Device::failWithErrno(const std::string& what) const {
  fail(what + ": " + describeErrno(errno));
}

void V4l2Device::checkCapabilities() {
  v4l2_capability capability{};
  if (xioctl(descriptor_, VIDIOC_QUERYCAP, &capability) < 0)
    fail("is not a V4L2 device; set the camera's device to one that 'v4l2-ctl --list-devices' lists");
  const std::uint32_t able = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? capability.device_caps
                                                                                   : capability.capabilities;
  if ((able & (V4L2_CAP_VIDEO_M2M | V4L2_CAP_VIDEO_M2M_MPLANE)) != 0)
    fail("is no camera: it converts pictures; 'v4l2-ctl --list-devices' names the cameras");
  if ((able & V4L2_CAP_VIDEO_CAPTURE) == 0) {
    if ((able & V4L2_CAP_VIDEO_CAPTURE_MPLANE) == 0)
      fail("captures no video; a camera often has a second device for metadata, try the other one");
    type_ = V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
  }
  if ((able & V4L2_CAP_STREAMING) == 0) fail("cannot stream through shared memory");
}

void V4l2Device::selectFormat(const V4l2Mode& mode) {
  const std::vector<std::uint32_t> offered = offeredFormats(descriptor_, type_);
  std::string problem = "offers none of GREY, NV12, YUYV and MJPEG";
  if (mode.format) problem = std::string("does not offer the format ") + formatName(*mode.format);
  for (std::size_t i = 0; i < offered.size(); ++i)
    problem += (i == 0 ? ", but " : ", ") + formatCode(offered[i]);
  if (!offered.empty() && !mode.format)
    problem += "; if these are a sensor's raw pictures, they need the camera's own converter (ISP) first";
  for (const auto& [format, code] : kFormats) {
    if (mode.format && *mode.format != format) continue;
    if (std::find(offered.begin(), offered.end(), code) == offered.end()) continue;
    const cv::Size size = requestFormat(code, mode.size);
    if (size == mode.size) {
      format_ = format;
      return;
    }
    const std::string chosen =
        size.empty() ? ", the device chose another format" : ", the nearest is " + toText(size);
    problem = std::string("has no ") + toText(mode.size) + " in " + formatName(format) + chosen +
              "; calibrate at a size that it supports ('v4l2-ctl --list-formats-ext')";
  }
  fail(problem);
}

/// Sets the format; returns the size that the device has chosen, an empty one if it has chosen another
/// format.
cv::Size V4l2Device::requestFormat(std::uint32_t code, const cv::Size& size) {
  const auto width = static_cast<std::uint32_t>(size.width), height = static_cast<std::uint32_t>(size.height);
  const bool is_planar = type_ == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
  v4l2_format wanted{};
  wanted.type = type_;
  v4l2_pix_format& single = wanted.fmt.pix;
  v4l2_pix_format_mplane& planar = wanted.fmt.pix_mp;
  if (is_planar) {
    planar.width = width, planar.height = height, planar.pixelformat = code;
    planar.field = V4L2_FIELD_NONE;
  } else {
    single.width = width, single.height = height, single.pixelformat = code;
    single.field = V4L2_FIELD_NONE;
  }
  if (xioctl(descriptor_, VIDIOC_S_FMT, &wanted) < 0) failWithErrno("rejects a format that it offers");
  stride_ = is_planar ? planar.plane_fmt[0].bytesperline : single.bytesperline;
  if ((is_planar ? planar.pixelformat : single.pixelformat) != code) return {};
  return is_planar ? cv::Size(static_cast<int>(planar.width), static_cast<int>(planar.height))
                   : cv::Size(static_cast<int>(single.width), static_cast<int>(single.height));
}

/// Sets the frame rate; ignores cameras that do not support setting it.
void V4l2Device::setFrameRate(double frame_rate) const {
  v4l2_streamparm parameters{};
  parameters.type = type_;
  v4l2_fract& interval = parameters.parm.capture.timeperframe;
  interval = {1000, static_cast<std::uint32_t>(std::lround(1000.0 * frame_rate))};
  if (xioctl(descriptor_, VIDIOC_S_PARM, &parameters) < 0) {
    if (errno == ENOTTY || errno == EINVAL) return;
    failWithErrno("rejects a frame rate");
  }
  if (interval.numerator == 0) return;
  const double got = static_cast<double>(interval.denominator) / interval.numerator;
  if (std::abs(got - frame_rate) > kRateTolerance * frame_rate)
    fail("cannot deliver " + roundedText(frame_rate) + " pictures per second, the nearest rate is " +
         roundedText(got) + "; set cameras.frame_rate to a rate that it supports");
}

void V4l2Device::setControls(const V4l2Mode& mode) const {
  if (mode.exposure) {
    if (hasControl(V4L2_CID_EXPOSURE_AUTO))
      setControl(V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL, "exposure");
    setControl(V4L2_CID_EXPOSURE_ABSOLUTE,
               static_cast<std::int32_t>(std::lround(*mode.exposure / kExposureUnit)), "exposure");
  }
  if (mode.gain) {
    if (hasControl(V4L2_CID_AUTOGAIN)) setControl(V4L2_CID_AUTOGAIN, 0, "gain");
    setControl(V4L2_CID_GAIN, *mode.gain, "gain");
  }
}

bool V4l2Device::hasControl(std::uint32_t id) const {
  v4l2_queryctrl query{};
  query.id = id;
  return xioctl(descriptor_, VIDIOC_QUERYCTRL, &query) == 0 && (query.flags & V4L2_CTRL_FLAG_DISABLED) == 0;
}

void V4l2Device::setControl(std::uint32_t id, std::int32_t value, const std::string& key) const {
  v4l2_queryctrl query{};
  query.id = id;
  if (xioctl(descriptor_, VIDIOC_QUERYCTRL, &query) < 0 || (query.flags & V4L2_CTRL_FLAG_DISABLED) != 0)
    fail("has no control for its " + key + "; leave '" + key + "' out of the configuration");
  v4l2_control setting{id, value};
  const bool in_range = value >= query.minimum && value <= query.maximum;
  if (in_range && xioctl(descriptor_, VIDIOC_S_CTRL, &setting) == 0) return;
  const double unit = id == V4L2_CID_EXPOSURE_ABSOLUTE ? kExposureUnit : 1.0;
  fail("does not accept the " + key + " " + roundedText(unit * value) + "; it can be " +
       roundedText(unit * query.minimum) + " to " + roundedText(unit * query.maximum));
}

void V4l2Device::mapBuffers() {
  v4l2_requestbuffers request{};
  request.count = kBufferCount;
  request.type = type_;
  request.memory = V4L2_MEMORY_MMAP;
  if (xioctl(descriptor_, VIDIOC_REQBUFS, &request) < 0) failWithErrno("provides no buffers");
  if (request.count < 2) fail("provides fewer than two buffers");
  for (std::uint32_t index = 0; index < request.count; ++index) {
    BufferRequest described(type_, index);
    if (xioctl(descriptor_, VIDIOC_QUERYBUF, &described.buffer) < 0) failWithErrno("provides no buffers");
    if (described.length() == 0)
      fail(std::string("describes buffers without a length") +
           (described.is_planar ? "; its driver's multi-planar interface cannot be used" : ""));
    void* const address = mmap(nullptr, described.length(), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor_,
                               described.offset());
    if (address == MAP_FAILED) failWithErrno("provides buffers that cannot be mapped");
    buffers_.push_back({address, described.length()});
    enqueue(index);
  }
}

void V4l2Device::enqueue(std::uint32_t index) const {
  BufferRequest request(type_, index);
  if (xioctl(descriptor_, VIDIOC_QBUF, &request.buffer) < 0) failWithErrno("does not accept a buffer");
}

std::optional<V4l2Buffer> V4l2Device::dequeue(std::chrono::steady_clock::time_point deadline, int interrupt) {
  if (dequeued_) {
    const std::uint32_t index = *dequeued_;
    dequeued_.reset();
    enqueue(index);
  }
  for (;;) {
    std::array<pollfd, 2> waiting{{{descriptor_, POLLIN, 0}, {interrupt, POLLIN, 0}}};
    const int ready = poll(waiting.data(), waiting.size(), millisecondsUntil(deadline));
    if (ready < 0 && errno == EINTR) continue;
    if (ready < 0) failWithErrno("cannot be waited for");
    if (ready == 0 || waiting[1].revents != 0) return std::nullopt;
    if ((waiting[0].revents & POLLIN) == 0) fail("was disconnected; is it plugged in?");

    BufferRequest filled(type_, 0);
    const v4l2_buffer& buffer = filled.buffer;
    if (xioctl(descriptor_, VIDIOC_DQBUF, &filled.buffer) < 0) {
      if (errno == EAGAIN) continue;
      failWithErrno("does not return a picture");
    }
    if (buffer.index >= buffers_.size()) fail("returns an unknown buffer");
    dequeued_ = buffer.index;
    const Mapping& mapping = buffers_[buffer.index];
    V4l2Buffer picture;
    const std::size_t end = std::min(filled.end(), mapping.length), begin = std::min(filled.begin(), end);
    picture.data = {static_cast<const std::uint8_t*>(mapping.address) + begin, end - begin};
    picture.monotonic =
        std::chrono::seconds(buffer.timestamp.tv_sec) + std::chrono::microseconds(buffer.timestamp.tv_usec);
    picture.sequence = buffer.sequence;
    picture.damaged = (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0;
    if ((buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC)
      fail(
          "does not time stamp its pictures by the kernel's monotonic clock; its driver is too old for "
          "stereo");
    return picture;
  }
}

}  // namespace cartvo::capture
