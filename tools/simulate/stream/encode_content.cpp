// Encodes a content to the two streams that the simulated cameras send.
#include "tools/simulate/stream/encode_content.hpp"

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

/// Encodes one key-frame interval of `image` as the stream's lead-in.
void addLeadIn(EncodedStream& stream, const cv::Mat& image, const EncoderSettings& settings) {
  StreamEncoder encoder(settings, stream.size, stream.frame_rate);
  const int count =
      std::max(1, static_cast<int>(std::lround(settings.key_frame_interval * stream.frame_rate)));
  for (int index = 0; index < count; ++index) {
    stream.lead_in.push_back(
        append(stream, encoder.encode(image), std::llround(index * 1e9 / stream.frame_rate)));
  }
}

/// Builds the stream of one camera.
class StreamWriter {
 public:
  StreamWriter(const EncoderSettings& settings, cv::Size size, const Content& content)
      : settings_(settings),
        starts_at_standstill_(content.startsAtStandstill()),
        encoder_(settings, size, content.frameRate()) {
    stream_.size = size;
    stream_.frame_rate = content.frameRate();
  }

  void add(const cv::Mat& image, std::int64_t instant_ns) {
    if (stream_.units.empty()) {
      if (starts_at_standstill_)
        addLeadIn(stream_, image, settings_);
      else
        addBlankLeadIn(stream_, settings_);
    }
    stream_.units.push_back(append(stream_, encoder_.encode(image), instant_ns));
  }

  EncodedStream releaseStream() { return std::move(stream_); }

 private:
  EncoderSettings settings_;
  bool starts_at_standstill_;
  StreamEncoder encoder_;
  EncodedStream stream_;
};

}  // namespace

void addBlankLeadIn(EncodedStream& stream, const EncoderSettings& settings) {
  constexpr double kGrey = 128;
  addLeadIn(stream, cv::Mat(stream.size, CV_8UC1, cv::Scalar(kGrey)), settings);
}

EncodedPair encodeContent(const Content& content, const EncoderSettings& settings, const Progress& progress) {
  const int count = content.pairCount();
  if (count < 1) throw std::invalid_argument("there is no image pair to encode");
  const calib::Rig rig = content.rig();
  StreamWriter left_writer(settings, rig.left.size, content);
  StreamWriter right_writer(settings, rig.right.size, content);

  cv::Mat left;
  cv::Mat right;
  for (int index = 0; index < count; ++index) {
    content.images(index, left, right);
    left_writer.add(left, content.leftInstant(index));
    right_writer.add(right, content.rightInstant(index));
    if (progress) progress(index + 1, count);
  }
  return {.left = left_writer.releaseStream(), .right = right_writer.releaseStream()};
}

}  // namespace cartvo::simulate
