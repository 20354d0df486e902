// Parsing of session descriptions.

#include "capture/rtsp/session_description.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "capture/rtsp/rtsp_message.hpp"
#include "common/ascii_text.hpp"
#include "common/base64.hpp"

namespace cartvo::capture {
namespace {

constexpr std::size_t kMaxOffered = 8;
constexpr std::size_t kMaxParameterSets = 16U << 10;  // bytes, in base64

/// One media section: its first payload type and the attributes that matter.
struct Media {
  bool is_video = false;
  bool is_encrypted = false;
  int payload_type = -1;
  std::string encoding;  ///< of the payload type, in capitals
  std::string parameters;
  std::string control;
};

/// Removes and returns the text up to the separator.
std::string_view take(std::string_view& text, char separator) {
  const std::size_t end = text.find(separator);
  const std::string_view part = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return trimmed(part);
}

int number(std::string_view text) {
  int value = -1;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

/// Appends base64 NAL units, separated by commas, each behind a start code. Units that are no base64 are
/// skipped: the stream repeats them.
void appendParameterSets(std::string_view list, std::vector<std::uint8_t>& sets) {
  while (!list.empty()) {
    std::string unit(take(list, ','));
    if (unit.empty() || unit.size() > kMaxParameterSets) continue;
    unit.erase(std::min(unit.find('='), unit.size()));  // some cameras pad too much, too little or not at all
    if (unit.size() % 4 == 1) unit.pop_back();          // less than a byte
    unit.append((4 - unit.size() % 4) % 4, '=');
    const std::optional<std::string> bytes = decodeBase64(unit);
    if (!bytes || bytes->empty()) continue;
    sets.insert(sets.end(), {0, 0, 0, 1});
    sets.insert(sets.end(), bytes->begin(), bytes->end());
  }
}

/// Parameter sets of an fmtp attribute, in the order in which a decoder needs them.
std::vector<std::uint8_t> parameterSetsOf(std::string_view parameters) {
  constexpr std::array<std::string_view, 4> kNames = {"SPROP-PARAMETER-SETS", "SPROP-VPS", "SPROP-SPS",
                                                      "SPROP-PPS"};
  std::array<std::string_view, kNames.size()> values;
  while (!parameters.empty()) {
    std::string_view value = take(parameters, ';');
    const std::string name = upperCase(take(value, '='));
    const auto found = std::find(kNames.begin(), kNames.end(), name);
    if (found != kNames.end()) values[static_cast<std::size_t>(found - kNames.begin())] = value;
  }
  std::vector<std::uint8_t> sets;
  for (const std::string_view value : values)
    appendParameterSets(value, sets);
  return sets;
}

/// Takes an attribute of a media section ("a=" line without the "a=").
void takeAttribute(std::string_view attribute, Media& media) {
  const std::string name = upperCase(take(attribute, ':'));
  if (name == "CONTROL") {
    media.control = trimmed(attribute);
    return;
  }
  if (name != "RTPMAP" && name != "FMTP") return;
  attribute = trimmed(attribute);
  if (number(take(attribute, ' ')) != media.payload_type) return;
  if (name == "FMTP") {
    media.parameters = trimmed(attribute);
  } else {
    attribute = trimmed(attribute);
    media.encoding = upperCase(take(attribute, '/'));
  }
}

/// Begins a section from the value of its "m=" line: "video 0 RTP/AVP 96".
Media beginMedia(std::string_view value) {
  Media media;
  media.is_video = upperCase(take(value, ' ')) == "VIDEO";
  take(value, ' ');  // port
  media.is_encrypted = upperCase(take(value, ' ')).find("/SAVP") != std::string::npos;
  media.payload_type = number(take(value, ' '));
  if (media.payload_type == 26) media.encoding = "JPEG";  // static payload types, RFC 3551, 6
  return media;
}

std::optional<VideoCodec> codecOf(const Media& media) {
  if (!media.is_video) return std::nullopt;
  if (media.encoding == "H264") return VideoCodec::h264;
  if (media.encoding == "H265" || media.encoding == "HEVC") return VideoCodec::h265;
  return std::nullopt;
}

}  // namespace

std::optional<VideoDescription> describedVideo(std::string_view description, std::string& offered) {
  offered.clear();
  std::string session_control;
  std::vector<Media> sections;
  while (!description.empty()) {
    const std::string_view line = take(description, '\n');
    if (line.size() < 2 || line[1] != '=') continue;
    const std::string_view value = line.substr(2);
    if (line[0] == 'm') {
      sections.push_back(beginMedia(value));
    } else if (line[0] == 'a' && !sections.empty()) {
      takeAttribute(value, sections.back());
    } else if (line[0] == 'a') {
      Media session;
      takeAttribute(value, session);
      if (!session.control.empty()) session_control = session.control;
    }
  }
  for (const bool is_encrypted : {false, true}) {
    for (const Media& media : sections) {
      const std::optional<VideoCodec> codec = codecOf(media);
      if (!codec || media.is_encrypted != is_encrypted) continue;
      return VideoDescription{{*codec, parameterSetsOf(media.parameters)},
                              media.payload_type,
                              media.control,
                              session_control,
                              is_encrypted};
    }
  }
  for (std::size_t i = 0; i < std::min(sections.size(), kMaxOffered); ++i) {
    const std::string name = quotedForMessage(sections[i].encoding);
    if (!name.empty()) offered += (offered.empty() ? "" : ", ") + name;
  }
  return std::nullopt;
}

}  // namespace cartvo::capture
