// Values of settings: reading, judging, choosing and writing them.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "common/ascii_text.hpp"
#include "common/http/listen_address.hpp"
#include "common/printable_text.hpp"
#include "tools/camera/camera_settings.hpp"

namespace cartvo {
namespace {

using capture::XmlDocument;

// Elements of a time server, below the list or at the root.
constexpr std::array<const char*, 2> kServerRoots{"NTPServer/", ""};

std::optional<double> numberOf(std::string_view text) {
  const std::string word(trimmed(text));
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// Seconds of "1/500" or "0.002".
std::optional<double> exposureOf(std::string_view text) {
  const std::size_t slash = text.find('/');
  const std::optional<double> numerator = numberOf(text.substr(0, slash));
  if (slash == std::string_view::npos) return numerator;
  const std::optional<double> denominator = numberOf(text.substr(slash + 1));
  if (!numerator || !denominator || *denominator <= 0.0) return std::nullopt;
  return *numerator / *denominator;
}

std::string exposureText(double seconds) {
  return fmt::format("1/{:.0f}", 1.0 / seconds);
}

std::string exactNumber(double value) {
  return fmt::format("{:.10g}", value);
}

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> words;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(separator), text.size());
    if (const std::string_view word = trimmed(text.substr(0, end)); !word.empty()) words.emplace_back(word);
    text.remove_prefix(std::min(text.size(), end + 1));
  }
  return words;
}

/// The first of the setting's paths that the document has.
std::optional<std::string> existingPath(const Setting& setting, const XmlDocument& document) {
  for (const std::string& path : setting.paths)
    if (document.has(path)) return path;
  return std::nullopt;
}

std::optional<std::string> timeServerOf(const XmlDocument& document) {
  for (const std::string root : kServerRoots) {
    const std::string format = lowerCase(document.text(root + "addressingFormatType").value_or(""));
    const bool by_name = format.starts_with("host");
    for (const std::string name :
         by_name ? std::array{"hostName", "ipAddress"} : std::array{"ipAddress", "hostName"})
      if (auto text = document.text(root + name); text && !text->empty()) return text;
  }
  return std::nullopt;
}

bool setTimeServer(XmlDocument& document, const std::string& value) {
  const bool is_address = isIpv4Address(value);
  for (const std::string root : kServerRoots) {
    if (!document.has(root + "addressingFormatType")) continue;
    document.setTexts(root + "addressingFormatType", is_address ? "ipaddress" : "hostname");
    return document.setOrAppend(root + (is_address ? "ipAddress" : "hostName"), value);
  }
  return false;
}

bool fitsOne(const Setting& setting, const std::string& value) {
  switch (setting.rule) {
    case Rule::choice:
      return std::any_of(setting.accepted.begin(), setting.accepted.end(),
                         [&](const std::string& accepted) { return sameValue(accepted, value); });
    case Rule::number: {
      const std::optional<double> number = numberOf(value);
      return number && *number >= setting.least && *number <= setting.most;
    }
    case Rule::shutter: {
      constexpr double kTolerance = 1e-9;  // s
      const std::optional<double> exposure = exposureOf(value);
      return exposure && *exposure > 0.0 && *exposure <= setting.most + kTolerance;
    }
    case Rule::any:
    case Rule::time_server:
      break;
  }
  return true;
}

/// How the camera calls "off": elements "enabled" are true or false, others have modes.
std::vector<std::string> switchedOff(const Setting& setting, const CameraDocuments& camera) {
  const std::optional<XmlDocument>& document = camera.of(setting.document);
  const std::string path = document ? existingPath(setting, *document).value_or("") : std::string();
  if (path.ends_with("nabled")) return {"false"};
  return {"close", "off"};
}

/// A number of the document as it is shown, in the setting's unit; other text unchanged.
std::string shown(const Setting& setting, const std::string& text) {
  const std::optional<double> number = setting.unit == 1.0 ? std::nullopt : numberOf(text);
  return number ? exactNumber(*number / setting.unit) : text;
}

/// Values in the order in which they are to be tried.
std::vector<std::string> candidates(const Setting& setting, const CameraDocuments& camera) {
  switch (setting.rule) {
    case Rule::choice:
      return isSwitch(setting) ? switchedOff(setting, camera) : setting.accepted;
    case Rule::number:
      return {exactNumber(setting.best), exactNumber(setting.most), exactNumber(setting.least)};
    case Rule::shutter: {
      std::vector<std::string> values = offeredValues(setting, camera);
      if (values.empty()) return {exposureText(setting.best)};
      std::erase_if(values, [&](const std::string& value) { return !fitsOne(setting, value); });
      const auto distance = [&](const std::string& value) {
        return std::abs(std::log(exposureOf(value).value_or(1.0) / setting.best));
      };
      std::stable_sort(values.begin(), values.end(), [&](const std::string& one, const std::string& other) {
        return distance(one) < distance(other);
      });
      return values;
    }
    case Rule::any:
    case Rule::time_server:
      break;
  }
  return {};
}

}  // namespace

bool isSwitch(const Setting& setting) {
  return setting.rule == Rule::choice && setting.accepted.front() == "false";
}

bool sameValue(const std::string& one, const std::string& other) {
  const std::optional<double> first = numberOf(one), second = numberOf(other);
  if (first && second) return *first == *second;
  return lowerCase(trimmed(one)) == lowerCase(trimmed(other));
}

bool alike(const Setting& setting, const std::string& one, const std::string& other,
           const OdometryNeeds& needs) {
  return sameValue(one, other) ||
         (setting.rule == Rule::time_server && isThisComputer(one, needs) && isThisComputer(other, needs));
}

bool isThisComputer(const std::string& time_server, const OdometryNeeds& needs) {
  return std::find(needs.host_addresses.begin(), needs.host_addresses.end(), time_server) !=
         needs.host_addresses.end();
}

std::optional<std::string> valueOf(const Setting& setting, const CameraDocuments& camera) {
  const std::optional<XmlDocument>& document = camera.of(setting.document);
  if (!document) return std::nullopt;
  if (setting.rule == Rule::time_server) {
    const auto server = timeServerOf(*document);
    return server ? std::optional(printableExcerpt(*server)) : std::nullopt;
  }
  const std::optional<std::string> path = existingPath(setting, *document);
  if (!path) return std::nullopt;
  std::vector<std::string> different;
  std::string joined;
  for (const std::string& raw : document->texts(*path)) {
    const std::string value = shown(setting, raw);
    if (std::find(different.begin(), different.end(), value) != different.end()) continue;
    different.push_back(value);
    joined += (joined.empty() ? "" : ", ") + value;
  }
  return printableExcerpt(joined);
}

bool setValue(const Setting& setting, XmlDocument& document, const std::string& value) {
  if (setting.rule == Rule::time_server) return setTimeServer(document, value);
  const std::optional<std::string> path = existingPath(setting, document);
  const std::optional<double> number = setting.unit == 1.0 ? std::nullopt : numberOf(value);
  return path && document.setTexts(*path, number ? exactNumber(*number * setting.unit) : value);
}

bool applies(const Setting& setting, const CameraDocuments& camera) {
  if (setting.condition_path.empty()) return true;
  const std::optional<XmlDocument>& document = camera.of(setting.document);
  return document && sameValue(document->text(setting.condition_path).value_or(""), setting.condition_value);
}

bool fits(const Setting& setting, const std::string& value) {
  const std::vector<std::string> values = split(value, ',');
  return std::all_of(values.begin(), values.end(),
                     [&](const std::string& one) { return fitsOne(setting, one); }) &&
         (!values.empty() || setting.rule == Rule::any);
}

std::string wantedText(const Setting& setting) {
  switch (setting.rule) {
    case Rule::choice:
      if (isSwitch(setting)) return "off";
      return fmt::format("{}", fmt::join(setting.accepted, " or "));
    case Rule::number:
      if (setting.least == setting.most) return exactNumber(setting.least);
      return exactNumber(setting.least) + " to " + exactNumber(setting.most);
    case Rule::shutter:
      return "at most " + exposureText(setting.most);
    case Rule::any:
    case Rule::time_server:
      break;
  }
  return setting.alike ? "the same on both cameras" : "as at calibration";
}

std::vector<std::string> offeredValues(const Setting& setting, const CameraDocuments& camera) {
  for (const XmlDocument* document :
       {camera.offersOf(setting.document),
        camera.of(setting.document) ? &*camera.of(setting.document) : nullptr}) {
    if (document == nullptr) continue;
    for (const std::string& path : setting.paths)
      if (const auto offered = document->attribute(path, "opt")) {
        std::vector<std::string> values = split(*offered, ',');
        std::erase_if(values, [](const std::string& value) { return printableExcerpt(value) != value; });
        for (std::string& value : values)
          value = shown(setting, value);
        return values;
      }
  }
  return {};
}

std::string offerProblem(const Setting& setting, const CameraDocuments& camera, const std::string& value) {
  if (setting.rule == Rule::number && !numberOf(value)) return "expected a number";
  if (setting.rule == Rule::shutter && !exposureOf(value)) return "expected an exposure such as 1/500";
  const std::vector<std::string> offered = offeredValues(setting, camera);
  const bool is_offered =
      offered.empty() || std::any_of(offered.begin(), offered.end(),
                                     [&](const std::string& one) { return sameValue(one, value); });
  if (!is_offered)
    return printableExcerpt(fmt::format("the camera offers {}", fmt::join(offered, ", ")), 200);
  const XmlDocument* document = camera.offersOf(setting.document);
  const std::optional<double> number = numberOf(value);
  if (document == nullptr || !number) return {};
  for (const std::string& path : setting.paths) {
    const auto least = numberOf(shown(setting, document->attribute(path, "min").value_or("")));
    const auto most = numberOf(shown(setting, document->attribute(path, "max").value_or("")));
    if ((least && *number < *least) || (most && *number > *most))
      return fmt::format("the camera offers {} to {}", least ? exactNumber(*least) : "any",
                         most ? exactNumber(*most) : "any");
  }
  return {};
}

std::optional<std::string> bestValue(const Setting& setting,
                                     const std::vector<const CameraDocuments*>& cameras) {
  if (cameras.empty()) return std::nullopt;
  for (const std::string& candidate : candidates(setting, *cameras.front())) {
    const bool is_offered = std::all_of(cameras.begin(), cameras.end(), [&](const CameraDocuments* camera) {
      return offerProblem(setting, *camera, candidate).empty();
    });
    if (is_offered && fitsOne(setting, candidate)) return candidate;
  }
  return std::nullopt;
}

}  // namespace cartvo
