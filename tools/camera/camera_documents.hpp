#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "capture/isapi/isapi_client.hpp"
#include "capture/isapi/xml_document.hpp"

// The documents of a camera that hold its settings.

namespace cartvo {

/// Documents of a camera with settings.
enum class Document : std::uint8_t { stream, image, overlays, time, time_servers };
constexpr std::array kDocuments{Document::stream, Document::image, Document::overlays, Document::time,
                                Document::time_servers};

/// Numbers of a camera's channels in ISAPI.
struct CameraChannels {
  int stream = 101;  ///< main stream 101, sub-stream 102
  int video = 1;
};

/// The channels that an RTSP URL names; those of the main stream if it names none.
CameraChannels channelsOf(const std::string& rtsp_url);

/// Path of a document.
std::string pathOf(Document document, const CameraChannels& channels);

/// Identity of a camera by its own statement; empty where it states none. Printable.
struct CameraIdentity {
  std::string name, model, serial_number, mac_address, firmware, firmware_date;
};

/// Identity and settings of a camera. A document that the camera does not have is missing.
struct CameraDocuments {
  CameraIdentity identity;
  CameraChannels channels;
  std::array<std::optional<capture::XmlDocument>, kDocuments.size()> documents;
  /// Values that the camera offers, of the stream and the image.
  std::optional<capture::XmlDocument> stream_offers, image_offers;

  const std::optional<capture::XmlDocument>& of(Document document) const {
    return documents[static_cast<std::size_t>(document)];
  }
  std::optional<capture::XmlDocument>& of(Document document) {
    return documents[static_cast<std::size_t>(document)];
  }
  /// The document with the values that the camera offers for another one; nothing if there is none.
  const capture::XmlDocument* offersOf(Document document) const;
};

/// Reads all documents, one after the other. Throws as IsapiClient::get.
CameraDocuments readCamera(capture::IsapiClient& client, const CameraChannels& channels);

}  // namespace cartvo
