#pragma once

#include <string>

namespace cartvo::daemon {

/// Reserves the odometry channel of one LCM group for this process, so that no second cartvod on this host
/// publishes there too. Ends with the process, however it ends. Programs in another network namespace are not
/// seen: they use other interfaces.
class ChannelReservation {
 public:
  /// `url`: as for connectLcm. Throws std::runtime_error that names the process that has the channel.
  explicit ChannelReservation(const std::string& url);
  ~ChannelReservation();
  ChannelReservation(const ChannelReservation&) = delete;
  ChannelReservation& operator=(const ChannelReservation&) = delete;

 private:
  int socket_;
};

}  // namespace cartvo::daemon
