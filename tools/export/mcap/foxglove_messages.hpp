#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "tools/export/exported_motion.hpp"

// Foxglove's messages in the wire format of Protocol Buffers; foxgloveSchema describes them.

namespace cartvo {

std::string foxgloveOdometry(const ExportedMotion& motion);
std::string foxglovePose(const ExportedMotion& motion);
std::string foxgloveTransform(std::int64_t time_ns, const FramePose& frame);
std::string foxgloveVideo(std::int64_t time_ns, const char* frame, std::span<const std::uint8_t> picture,
                          const char* codec);

/// A line of the log; a warning or, otherwise, information.
std::string foxgloveLog(std::int64_t time_ns, bool is_warning, const std::string& text);

}  // namespace cartvo
