// The configured cameras' ISAPI.
#include "tools/camera/camera_access.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <system_error>

#include "calib/format/rig_file.hpp"
#include "capture/isapi/isapi_client.hpp"
#include "capture/rtsp/rtsp_url.hpp"
#include "daemon/service/camera_password.hpp"
#include "tools/camera/network/camera_ports.hpp"

namespace cartvo {
namespace {

std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::milliseconds(std::llround(1e3 * seconds));
}

std::string keyOf(const capture::IsapiSettings& settings, capture::KnownCameras& known) {
  if (const auto key = known.keyOf(settings.address)) return *key;
  capture::HttpConnection connection(settings.address, settings.timeout);
  std::string key = connection.fetchKey();
  known.add(settings.address, key);
  std::fprintf(stderr,
               "cartvo: met %s for the first time; its key %s is kept in %s and required from now on\n",
               settings.address.url().c_str(), key.c_str(), known.file().c_str());
  return key;
}

CameraAccess openCamera(const std::string& side, const daemon::CameraConfiguration& camera,
                        const AccessOptions& options) {
  if (camera.isV4l2()) {
    throw std::runtime_error("the " + side + " camera is a V4L2 camera (" + camera.url +
                             "): it has no ISAPI; its exposure and gain are set in the configuration");
  }
  capture::IsapiSettings settings = withoutLogin(camera, options);
  settings.credentials = {camera.username, daemon::readPassword(camera)};
  CameraChannels channels = channelsOf(camera.url);
  if (options.channel) channels = channelsOf("channels/" + std::to_string(*options.channel));
  return {side, channels, std::make_unique<capture::IsapiClient>(settings)};
}

}  // namespace

capture::IsapiSettings withoutLogin(const daemon::CameraConfiguration& camera, const AccessOptions& options) {
  capture::IsapiSettings settings;
  const int port = options.http_port.value_or(options.https ? capture::kHttpsPort : capture::kHttpPort);
  settings.address = {capture::parseRtspUrl(camera.url).host, static_cast<std::uint16_t>(port),
                      options.https};
  settings.timeout = milliseconds(options.timeout);
  if (!options.https) return settings;
  capture::KnownCameras known(options.known_cameras.empty()
                                  ? options.configuration.parent_path() / "known-cameras"
                                  : options.known_cameras);
  settings.key = keyOf(settings, known);
  return settings;
}

std::vector<CameraAccess> openCameras(const daemon::Configuration& configuration,
                                      const AccessOptions& options) {
  std::vector<CameraAccess> cameras;
  if (options.side != "right") cameras.push_back(openCamera("left", configuration.left, options));
  if (options.side != "left") cameras.push_back(openCamera("right", configuration.right, options));
  return cameras;
}

void addThisComputer(OdometryNeeds& needs, const daemon::Configuration& configuration) {
  std::vector<HostAddress> addresses;
  try {
    addresses = hostAddresses();
  } catch (const std::runtime_error&) {
    return;
  }
  for (const HostAddress& address : addresses)
    needs.host_addresses.push_back(ipv4Text(address.address));
  const std::array cameras{&configuration.left, &configuration.right};
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    if (!cameras[i]->isV4l2())
      needs.addresses_near[i] = addressNear(capture::parseRtspUrl(cameras[i]->url).host, addresses);
  }
}

OdometryNeeds needsOf(const daemon::Configuration& configuration) {
  OdometryNeeds needs;
  needs.frame_rate = configuration.frame_rate;
  addThisComputer(needs, configuration);
  std::error_code error;
  if (configuration.rig.empty() || !std::filesystem::exists(configuration.rig, error)) return needs;
  const calib::Rig rig = calib::readRig(configuration.rig);
  needs.width = rig.left.size.width;
  needs.height = rig.left.size.height;
  return needs;
}

}  // namespace cartvo
