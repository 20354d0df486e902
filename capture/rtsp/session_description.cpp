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
constexpr std::size_t kMaxPayloads = 16;              ///< of one media section
constexpr std::size_t kMaxParameterSets = 16U << 10;  // bytes, in base64

/// One payload type of a media section.
struct Payload {
  int type = -1;
  std::string encoding;  ///< in capitals
  std::string parameters;
};

/// One media section: its payload types and the attributes that matter.
struct Media {
  bool is_video = false;
  bool is_encrypted = false;
  std::vector<Payload> payloads;
  std::string control;
};

/// Removes and returns the text up to the separator.
std::string_view take(std::string_view& text, char separator) {
  const std::size_t end = text.find(separator);
  const std::string_view part = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return trimmed(part);
}

/// Removes and returns a line, which ends with CR LF, or with one of them.
std::string_view takeDescriptionLine(std::string_view& text) {
  const std::size_t end = text.find_first_of("\r\n");
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return trimmed(line);
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
  const int type = number(take(attribute, ' '));
  const auto payload = std::find_if(media.payloads.begin(), media.payloads.end(),
                                    [type](const Payload& one) { return one.type == type; });
  if (payload == media.payloads.end()) return;
  attribute = trimmed(attribute);
  if (name == "FMTP") {
    payload->parameters = attribute;
  } else {
    payload->encoding = upperCase(take(attribute, '/'));
  }
}

/// Begins a section from the value of its "m=" line: "video 0 RTP/AVP 96 97".
Media beginMedia(std::string_view value) {
  Media media;
  media.is_video = upperCase(take(value, ' ')) == "VIDEO";
  take(value, ' ');  // port
  media.is_encrypted = upperCase(take(value, ' ')).find("/SAVP") != std::string::npos;
  while (!value.empty() && media.payloads.size() < kMaxPayloads) {
    Payload payload;
    payload.type = number(take(value, ' '));
    if (payload.type == 26) payload.encoding = "JPEG";  // static payload types, RFC 3551, 6
    if (payload.type >= 0) media.payloads.push_back(payload);
  }
  return media;
}

/// The codec of a payload type: as named, or by its parameter sets if it has no name.
std::optional<VideoCodec> codecOf(const Payload& payload) {
  if (payload.encoding == "H264") return VideoCodec::h264;
  if (payload.encoding == "H265" || payload.encoding == "HEVC") return VideoCodec::h265;
  if (!payload.encoding.empty()) return std::nullopt;
  const std::string parameters = upperCase(payload.parameters);
  if (parameters.find("SPROP-PARAMETER-SETS") != std::string::npos) return VideoCodec::h264;
  if (parameters.find("SPROP-VPS") != std::string::npos) return VideoCodec::h265;
  return std::nullopt;
}

/// The first H.264 or H.265 payload type of the sections with or without encryption.
std::optional<VideoDescription> videoOf(const std::vector<Media>& sections, bool is_encrypted,
                                        const std::string& session_control) {
  for (const Media& media : sections) {
    if (!media.is_video || media.is_encrypted != is_encrypted) continue;
    for (const Payload& payload : media.payloads) {
      const std::optional<VideoCodec> codec = codecOf(payload);
      if (!codec) continue;
      return VideoDescription{{*codec, parameterSetsOf(payload.parameters)},
                              payload.type,
                              media.control,
                              session_control,
                              is_encrypted};
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<VideoDescription> describedVideo(std::string_view description, std::string& offered) {
  offered.clear();
  std::string session_control;
  std::vector<Media> sections;
  while (!description.empty()) {
    const std::string_view line = takeDescriptionLine(description);
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
    if (auto video = videoOf(sections, is_encrypted, session_control)) return video;
  }
  std::size_t names = 0;
  for (const Media& media : sections) {
    for (const Payload& payload : media.payloads) {
      const std::string name = quotedForMessage(payload.encoding);
      if (!name.empty() && names++ < kMaxOffered) offered += (offered.empty() ? "" : ", ") + name;
    }
  }
  return std::nullopt;
}

}  // namespace cartvo::capture
