#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "tools/export/encoded_pictures.hpp"
#include "tools/export/export_source.hpp"
#include "tools/export/mcap/mcap_writer.hpp"

namespace cartvo {

/// Makes the message of a picture. `frame`: the camera's, `codec`: as EncodedPictures::codec.
using PictureMessage = std::function<std::string(std::int64_t exposure_ns, const char* frame,
                                                 std::span<const std::uint8_t> picture, const char* codec)>;

/// Writes the pictures of both cameras of a recording, as they were sent, into the topics /left/video and
/// /right/video of an MCAP file. Writes nothing if the source has no video.
class PictureChannels {
 public:
  /// `writer` is borrowed. `add_channel` returns the channel's number for a topic.
  PictureChannels(McapWriter& writer, const ExportSource& source,
                  const std::function<std::uint16_t(const char* topic)>& add_channel, PictureMessage message);

  /// Writes the pictures that arrived up to that instant, in the order of their arrival.
  void writeUntil(std::int64_t time_ns);

  std::size_t writtenCount() const { return written_; }

 private:
  struct Camera {
    std::unique_ptr<EncodedPictures> pictures;  ///< empty without video
    const char* frame = nullptr;
    std::uint16_t channel = 0;
  };

  /// The camera whose next picture arrived first; null if there is no next picture.
  const Camera* next() const;

  McapWriter& writer_;
  PictureMessage message_;
  std::array<Camera, 2> cameras_;
  std::size_t written_ = 0;
};

}  // namespace cartvo
