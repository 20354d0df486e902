#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <cartvo/odometry_t.hpp>

namespace cartvo::daemon {

/// Receives CARTVO_ODOMETRY to find another program that publishes on it: a second cartvod, a replay, or a
/// daemon of another release. Controllers would then receive two motions. A thread of its own receives,
/// because LCM tests the route of the group first, which takes up to 20 s if nothing comes back.
class ForeignOdometry {
 public:
  /// `url`: as for connectLcm. Where LCM receives nothing, no foreign messages are found.
  explicit ForeignOdometry(const std::string& url);

  /// Does not wait for LCM's test of the route.
  ~ForeignOdometry();
  ForeignOdometry(const ForeignOdometry&) = delete;
  ForeignOdometry& operator=(const ForeignOdometry&) = delete;

  /// Notes a message of this daemon. Called for each, before the next `consumeProblem`.
  void addOwn(const odometry_t& message);

  /// Whether another daemon would have been received by now. Before that, this daemon should not publish.
  bool hasListened() const;

  /// Which foreign messages came since the last call, as text for the operator; empty: none.
  std::string consumeProblem();

 private:
  using Identity = std::pair<std::int64_t, std::int64_t>;  ///< sequence, publication_utime
  struct Receiver;

  std::chrono::steady_clock::time_point begin_;
  std::deque<Identity> own_;  ///< the last ones
  std::shared_ptr<Receiver> receiver_;
  std::thread thread_;
};

}  // namespace cartvo::daemon
