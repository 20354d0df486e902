#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>

namespace cartvo::daemon {

/// Receives CARTVO_ODOMETRY to find another program that publishes on it: a second cartvod, a replay, or a
/// daemon of another release. Controllers would then receive two motions. A thread of its own receives,
/// because LCM tests the route of the group first, which takes up to 20 s if nothing comes back.
class ForeignOdometry {
 public:
  /// `url`: as for connectLcm. `own_source_id`: of this daemon's messages. Where LCM receives nothing, no
  /// foreign messages are found.
  ForeignOdometry(const std::string& url, std::int64_t own_source_id);

  /// Does not wait for LCM's test of the route.
  ~ForeignOdometry();
  ForeignOdometry(const ForeignOdometry&) = delete;
  ForeignOdometry& operator=(const ForeignOdometry&) = delete;

  /// Whether another daemon would have been received by now. Before that, this daemon should not publish.
  bool hasListened() const;

  /// Which foreign messages came since the last call, as text for the operator; empty: none.
  std::string consumeProblem();

 private:
  struct Receiver;

  std::chrono::steady_clock::time_point begin_;
  std::shared_ptr<Receiver> receiver_;
  std::thread thread_;
};

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
