// Writes the pictures of a recording into an MCAP file.
#include "tools/export/mcap/picture_channels.hpp"

#include <utility>

#include "tools/export/exported_motion.hpp"

namespace cartvo {

PictureChannels::PictureChannels(McapWriter& writer, const ExportSource& source,
                                 const std::function<std::uint16_t(const char* topic)>& add_channel,
                                 PictureMessage message)
    : writer_(writer), message_(std::move(message)) {
  if (!source.has_video) return;
  using capture::CameraSide;
  cameras_ = {Camera{std::make_unique<EncodedPictures>(source.path, CameraSide::left), kLeftCameraFrame,
                     add_channel("/left/video")},
              Camera{std::make_unique<EncodedPictures>(source.path, CameraSide::right), kRightCameraFrame,
                     add_channel("/right/video")}};
}

const PictureChannels::Camera* PictureChannels::next() const {
  const Camera* first = nullptr;
  for (const Camera& camera : cameras_) {
    if (!camera.pictures || camera.pictures->isFinished()) continue;
    if (first == nullptr || camera.pictures->arrivalNs() < first->pictures->arrivalNs()) first = &camera;
  }
  return first;
}

void PictureChannels::writeUntil(std::int64_t time_ns) {
  for (const Camera* camera = next(); camera != nullptr; camera = next()) {
    EncodedPictures& pictures = *camera->pictures;
    if (pictures.arrivalNs() > time_ns) return;
    const auto time = static_cast<std::uint64_t>(pictures.arrivalNs());
    writer_.write(camera->channel, time, time,
                  message_(pictures.exposureNs(), camera->frame, pictures.data(), pictures.codec()));
    pictures.advance();
    ++written_;
  }
}

}  // namespace cartvo
