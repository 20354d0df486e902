#pragma once

#include <string>

#include "capture/isapi/isapi_client.hpp"
#include "support/camera/isapi_server.hpp"
#include "tools/camera/camera_documents.hpp"

// Reading of simulated cameras in tests.

namespace cartvo::test {

inline capture::IsapiSettings isapiSettings(const IsapiServer& server) {
  capture::IsapiSettings settings;
  settings.address = {"127.0.0.1", static_cast<std::uint16_t>(server.port()), false};
  settings.credentials = {"admin", "camera-password"};
  settings.retry_pause = std::chrono::milliseconds(1);
  return settings;
}

/// Identity and settings of a simulated camera.
inline CameraDocuments readSimulatedCamera(const IsapiServer& server) {
  capture::IsapiClient client(isapiSettings(server));
  return readCamera(client, {});
}

/// The documents with one text replaced wherever it is.
inline IsapiDocuments replaced(IsapiDocuments documents, const std::string& from, const std::string& to) {
  for (auto& [path, text] : documents)
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
      text.replace(at, from.size(), to);
  return documents;
}

}  // namespace cartvo::test
