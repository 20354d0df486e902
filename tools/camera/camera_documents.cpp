// Reads the documents of a camera that hold its settings.
#include "tools/camera/camera_documents.hpp"

#include <charconv>

#include "common/ascii_text.hpp"
#include "common/printable_text.hpp"

namespace cartvo {
namespace {

using capture::XmlDocument;

CameraIdentity identityOf(const XmlDocument& document) {
  const auto text = [&](const char* name) { return printableExcerpt(document.text(name).value_or("")); };
  return {text("deviceName"), text("model"),           text("serialNumber"),
          text("macAddress"), text("firmwareVersion"), text("firmwareReleasedDate")};
}

/// The number after the last "channels/" of a lower-case URL.
std::optional<int> channelNumber(const std::string& url) {
  constexpr std::string_view kBefore = "channels/";
  const std::size_t begin = url.rfind(kBefore);
  if (begin == std::string::npos) return std::nullopt;
  int number = 0;
  const char* first = url.data() + begin + kBefore.size();
  if (std::from_chars(first, url.data() + url.size(), number).ec != std::errc()) return std::nullopt;
  return number;
}

}  // namespace

CameraChannels channelsOf(const std::string& rtsp_url) {
  constexpr int kFirst = 101, kLast = 9999, kStreamsOfChannel = 100;
  const std::string url = lowerCase(rtsp_url);
  const int fallback =
      url.find("/sub/") == std::string::npos ? kFirst : kFirst + 1;  // /h264/ch1/sub/av_stream
  const int number = channelNumber(url).value_or(fallback);
  if (number < kFirst || number > kLast) return {};
  return {number, number / kStreamsOfChannel};
}

std::string pathOf(Document document, const CameraChannels& channels) {
  const std::string video = std::to_string(channels.video);
  switch (document) {
    case Document::stream:
      return "/ISAPI/Streaming/channels/" + std::to_string(channels.stream);
    case Document::image:
      return "/ISAPI/Image/channels/" + video;
    case Document::overlays:
      return "/ISAPI/System/Video/inputs/channels/" + video + "/overlays";
    case Document::time:
      return "/ISAPI/System/time";
    case Document::time_servers:
      break;
  }
  return "/ISAPI/System/time/ntpServers";
}

const XmlDocument* CameraDocuments::offersOf(Document document) const {
  if (document == Document::stream && stream_offers) return &*stream_offers;
  if (document == Document::image && image_offers) return &*image_offers;
  return nullptr;
}

CameraDocuments readCamera(capture::IsapiClient& client, const CameraChannels& channels) {
  CameraDocuments camera;
  camera.channels = channels;
  camera.identity = identityOf(client.get("/ISAPI/System/deviceInfo"));
  for (const Document document : kDocuments)
    camera.of(document) = client.getIfSupported(pathOf(document, channels));
  const std::string capabilities = "/capabilities";
  camera.stream_offers = client.getIfSupported(pathOf(Document::stream, channels) + capabilities);
  camera.image_offers = client.getIfSupported(pathOf(Document::image, channels) + capabilities);
  return camera;
}

}  // namespace cartvo
