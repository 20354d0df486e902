#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "capture/isapi/xml_document.hpp"
#include "tools/camera/camera_documents.hpp"

// The settings of a camera that matter to odometry, what they must be, and why.

namespace cartvo {

/// How the value of a setting is judged.
enum class Rule : std::uint8_t {
  choice,       ///< one of `accepted`; the first is the best
  number,       ///< `least` to `most`
  shutter,      ///< an exposure limit such as 1/500 of at most `most` seconds
  any,          ///< any value; see `alike`
  time_server,  ///< any host; see `alike`
};

/// One setting of a camera.
struct Setting {
  std::string name;  ///< on the command line, for example "wdr"
  std::string title;
  std::string reason;  ///< why odometry needs it
  Document document = Document::stream;
  std::vector<std::string> paths;  ///< in the document; the first that exists counts
  Rule rule = Rule::any;
  std::vector<std::string> accepted = {};
  double least = 0.0, most = 0.0;
  double best = 0.0;  ///< number or shutter that is set
  double unit = 1.0;  ///< of the document's number: 100 if it counts hundredths
  bool alike = true;  ///< both cameras need the same value
  /// The setting counts only while the element at this path of the same document has this value.
  std::string condition_path = {}, condition_value = {};
  bool is_required = false;  ///< a camera that does not report it cannot be judged
};

/// Needs of the odometry beside the fixed values.
struct OdometryNeeds {
  std::optional<double> frame_rate;  ///< Hz; nothing: 15 to 30, the same on both
  int bit_rate = 4096;               ///< kbit/s, at least
  std::optional<int> width, height;  ///< px, of the rig
  /// IPv4 addresses of this computer. Cameras at two ports have one time server at two addresses.
  std::vector<std::string> host_addresses = {};
  /// This computer's address in the network of the left and the right camera; empty: it is in none of theirs.
  std::array<std::string, 2> addresses_near = {};
};

/// All settings, for cameras that run at `frame_rate` Hz.
std::vector<Setting> cameraSettings(const OdometryNeeds& needs, double frame_rate);

/// The needed frame rate, Hz: the stated one, else that of the camera if it is usable, else 18.
double frameRateOf(const OdometryNeeds& needs, const CameraDocuments& camera);

/// Value of a setting, printable: the different values joined by ", " where several elements have that path,
/// such as texts of the overlay. Nothing if the camera does not report it.
std::optional<std::string> valueOf(const Setting& setting, const CameraDocuments& camera);

/// Sets a value in the setting's document. False if the document has no such element.
bool setValue(const Setting& setting, capture::XmlDocument& document, const std::string& value);

/// Whether the setting's condition holds.
bool applies(const Setting& setting, const CameraDocuments& camera);

/// Whether a value is good for odometry.
bool fits(const Setting& setting, const std::string& value);

/// The values that are good for odometry, as text: "off", "at most 1/250".
std::string wantedText(const Setting& setting);

/// Whether the setting is something that must be off. Firmwares call that "false", "close" or "off".
bool isSwitch(const Setting& setting);

/// Whether both values mean the same, "1/25" and "1/25 " or "CBR" and "cbr".
bool sameValue(const std::string& one, const std::string& other);

/// Whether values of a setting on two cameras are the same. Two addresses of this computer are the same time
/// server.
bool alike(const Setting& setting, const std::string& one, const std::string& other,
           const OdometryNeeds& needs);

/// Whether a time server is this computer.
bool isThisComputer(const std::string& time_server, const OdometryNeeds& needs);

/// Values that the camera offers for a setting; empty if it names none.
std::vector<std::string> offeredValues(const Setting& setting, const CameraDocuments& camera);

/// Why the camera does not take a value, by what it offers; empty if nothing is known against it.
std::string offerProblem(const Setting& setting, const CameraDocuments& camera, const std::string& value);

/// The best value that all the cameras offer; nothing if there is none or the rule names none.
std::optional<std::string> bestValue(const Setting& setting,
                                     const std::vector<const CameraDocuments*>& cameras);

}  // namespace cartvo
