#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace cartvo::simulate {

/// Encoder settings; the defaults are those of a well-configured surveillance camera.
struct EncoderSettings {
  int bitrate_kbps = 4000;          ///< constant bit rate, with a buffer of half a second
  double key_frame_interval = 1.0;  ///< s
  int slices = 1;                   ///< per picture
};

/// Cache key of everything that the encoded bytes depend on besides the pictures.
std::string encoderKey(const EncoderSettings& settings);

/// An encoded picture in annex B format; a key frame starts with its parameter sets.
struct EncodedPicture {
  std::vector<std::uint8_t> data;
  bool key_frame = false;
};

/// H.264 main profile as in IP cameras: no B-frames, no look-ahead, no delay. The same pictures give the same
/// bytes, because libx264 runs in one thread.
class StreamEncoder {
 public:
  /// Throws std::invalid_argument for a size with an odd side (4:2:0 chroma) or settings out of range.
  StreamEncoder(const EncoderSettings& settings, cv::Size size, double frame_rate);
  ~StreamEncoder();
  StreamEncoder(const StreamEncoder&) = delete;
  StreamEncoder& operator=(const StreamEncoder&) = delete;

  /// Encodes `image` (CV_8UC1, of the encoder's size) as luma plane in full range; chroma is neutral.
  EncodedPicture encode(const cv::Mat& image);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo::simulate
