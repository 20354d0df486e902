#pragma once

#include <string>

namespace cartvo {

/// The schema of one of Foxglove's messages ("foxglove.Odometry", ...) as MCAP expects it of Protocol
/// Buffers: a FileDescriptorSet with the message and all that it uses. Field numbers and types are those that
/// Foxglove documents; fields that cartvo does not write are left out. Throws std::out_of_range for a message
/// that cartvo does not write.
std::string foxgloveSchema(const std::string& message);

}  // namespace cartvo
