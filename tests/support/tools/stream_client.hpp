#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cartvo::test {

/// A packet that a client of a simulated camera has received.
struct ReceivedPacket {
  std::int64_t pts = 0;  ///< units of 1/90000 s
  bool key_frame = false;
  /// Exposure by sender reports (AV_PKT_DATA_PRFT), ns since the Unix epoch; 0 before the first report.
  std::int64_t instant_ns = 0;
  std::int64_t arrival_ns = 0;  ///< ns since the Unix epoch
};

/// Result of receive().
struct ReceivedStream {
  int open_error = 0;  ///< error code of libavformat; 0: opened
  bool ended = false;  ///< the camera ended the stream
  std::vector<ReceivedPacket> packets;
};

/// Plays a camera over TCP until `packets` are received, the stream ends, or no packet arrives within the
/// tests' time limit.
ReceivedStream receive(std::uint16_t port, const std::string& user_and_password, int packets);

}  // namespace cartvo::test
