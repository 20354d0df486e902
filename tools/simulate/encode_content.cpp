// From a content's pictures to the two streams that the simulated cameras send.
#include "tools/simulate/encode_content.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace cartvo::simulate {
namespace {

AccessUnit append(EncodedStream& stream, const EncodedPicture& picture, std::int64_t instant_ns) {
  const AccessUnit unit{.instant_ns = instant_ns,
                        .begin = stream.bytes.size(),
                        .size = picture.data.size(),
                        .key_frame = picture.key_frame};
  stream.bytes.insert(stream.bytes.end(), picture.data.begin(), picture.data.end());
  return unit;
}

/// One camera's stream in the making.
class StreamWriter {
 public:
  StreamWriter(const EncoderSettings& settings, cv::Size size, double frame_rate)
      : settings_(settings), encoder_(settings, size, frame_rate) {
    stream_.size = size;
    stream_.frame_rate = frame_rate;
  }

  void add(const cv::Mat& image, std::int64_t instant_ns) {
    if (stream_.units.empty()) addLeadIn(image);
    stream_.units.push_back(append(stream_, encoder_.encode(image), instant_ns));
  }

  EncodedStream take() { return std::move(stream_); }

 private:
  // Exactly from one key frame to the next, so that it can be repeated.
  void addLeadIn(const cv::Mat& image) {
    StreamEncoder still(settings_, stream_.size, stream_.frame_rate);
    const int count =
        std::max(1, static_cast<int>(std::lround(settings_.key_frame_interval * stream_.frame_rate)));
    for (int index = 0; index < count; ++index) {
      stream_.lead_in.push_back(
          append(stream_, still.encode(image), std::llround(index * 1e9 / stream_.frame_rate)));
    }
  }

  EncoderSettings settings_;
  StreamEncoder encoder_;
  EncodedStream stream_;
};

}  // namespace

EncodedPair encodeContent(const Content& content, const EncoderSettings& settings, const Progress& progress) {
  const int count = content.pairCount();
  if (count < 1) throw std::invalid_argument("there is no image pair to encode");
  const Rig rig = content.rig();
  StreamWriter left_writer(settings, rig.left.size, content.frameRate());
  StreamWriter right_writer(settings, rig.right.size, content.frameRate());

  cv::Mat left;
  cv::Mat right;
  for (int index = 0; index < count; ++index) {
    content.images(index, left, right);
    left_writer.add(left, content.leftInstant(index));
    right_writer.add(right, content.rightInstant(index));
    if (progress) progress(index + 1, count);
  }
  return {.left = left_writer.take(), .right = right_writer.take()};
}

}  // namespace cartvo::simulate
