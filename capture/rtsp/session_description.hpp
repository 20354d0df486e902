#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "capture/encoded_unit.hpp"

namespace cartvo::capture {

/// The video stream of a session description (SDP, RFC 8866; fmtp parameters of RFC 6184 and RFC 7798).
struct VideoDescription {
  StreamFormat format;
  int payload_type = 0;
  std::string control;          ///< of the stream; may be relative or empty
  std::string session_control;  ///< of the session; may be empty
  bool is_encrypted = false;    ///< by SRTP (RFC 3711), the profiles RTP/SAVP and RTP/SAVPF
};

/// The first H.264 or H.265 video stream, one without encryption if there is one. Nothing if there is none;
/// `offered` receives the encodings that there are, for a message ("JPEG, PCMU"), or is empty.
std::optional<VideoDescription> describedVideo(std::string_view description, std::string& offered);

}  // namespace cartvo::capture
