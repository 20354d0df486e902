#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cartvo::test {

/// What a client of a simulated camera has seen, through libavformat and libavcodec.
struct ReceivedPacket {
  std::int64_t pts = 0;  ///< 90 kHz
  bool key_frame = false;
  std::int64_t instant_ns =
      0;  ///< from the sender reports (AV_PKT_DATA_PRFT), Unix epoch; 0 before the first
  std::int64_t arrival_ns = 0;  ///< Unix epoch
};

struct ReceivedStream {
  int open_error = 0;  ///< libavformat's, 0: opened
  bool ended = false;  ///< the camera said that nothing more follows
  std::vector<ReceivedPacket> packets;
};

/// Plays a camera over TCP until `packets` have come, it ends, or five seconds pass without one.
ReceivedStream receive(std::uint16_t port, const std::string& user_and_password, int packets);

}  // namespace cartvo::test
