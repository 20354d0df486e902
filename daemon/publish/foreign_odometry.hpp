#pragma once

#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <cartvo/odometry_t.hpp>

namespace lcm {
class LCM;
struct ReceiveBuffer;
}  // namespace lcm

namespace cartvo::daemon {

/// Receives CARTVO_ODOMETRY to find another program that publishes on it: a second cartvod, a replay, or a
/// daemon of another release. Controllers would then receive two motions. A thread of its own receives,
/// because LCM tests the route of the group first, which takes up to 10 s if nothing comes back.
class ForeignOdometry {
 public:
  /// `url`: as for connectLcm. Where LCM receives nothing, no foreign messages are found.
  explicit ForeignOdometry(std::string url);

  /// Notes a message of this daemon. Called for each, before the next `consumeProblem`.
  void addOwn(const odometry_t& message);

  /// Which foreign messages came since the last call, as text for the operator; empty: none.
  std::string consumeProblem();

 private:
  using Identity = std::pair<std::int64_t, std::int64_t>;  ///< sequence, publication_utime

  void receive(const std::stop_token& stop);
  void onData(const lcm::ReceiveBuffer* buffer, const std::string& channel);

  std::string url_;
  std::deque<Identity> own_;  ///< the last ones
  std::mutex mutex_;          ///< guards the following
  std::vector<Identity> received_;
  std::size_t undecodable_ = 0;
  std::jthread thread_;  ///< last: it ends before the rest is destroyed
};

}  // namespace cartvo::daemon
