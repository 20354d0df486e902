// Order of received messages: newest, lost, repeated, of a restarted daemon, of two daemons.

#include <cartvo/client.hpp>

namespace cartvo::client {
namespace {

constexpr std::chrono::seconds kRestartTime{2};  // a daemon does not restart twice in this time

}  // namespace

bool NewestOdometry::add(const odometry_t& message, SteadyClock::time_point reception) {
  const bool same_source = message.source_id == message_.source_id;
  const bool is_newer = (same_source && message.sequence > message_.sequence) ||
                        message.publication_utime > message_.publication_utime ||
                        reception - last_reception_ > silence_;
  if (kept_ > 0 && !is_newer) {
    ++ignored_;
    return false;
  }
  if (kept_ > 0) countSince(message, reception);
  message_ = message;
  last_reception_ = reception;
  ++kept_;
  return true;
}

/// Counts what happened between the kept message and the next one.
void NewestOdometry::countSince(const odometry_t& message, SteadyClock::time_point reception) {
  const bool has_restarted = message.source_id != message_.source_id || message.sequence <= message_.sequence;
  if (has_restarted || message.reset_counter != message_.reset_counter) ++epoch_;
  if (has_restarted) {
    second_restart_ = last_restart_;
    last_restart_ = reception;
    lost_ = 0;
  } else if (message_.sequence >= 0) {  // then the difference does not overflow
    lost_ += message.sequence - message_.sequence - 1;
  }
}

bool NewestOdometry::hasTwoPublishers(SteadyClock::time_point now) const {
  return second_restart_ != SteadyClock::time_point{} && now - second_restart_ < kRestartTime &&
         last_restart_ - second_restart_ < kRestartTime;
}

}  // namespace cartvo::client
