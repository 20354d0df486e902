// Finds other programs that publish odometry on the daemon's channel.
#include "daemon/publish/foreign_odometry.hpp"

#include <algorithm>

#include <lcm/lcm-cpp.hpp>
#include <spdlog/spdlog.h>

#include "daemon/publish/lcm_connection.hpp"

namespace cartvo::daemon {
namespace {

constexpr std::size_t kMaxKept = 1000;  // messages; several seconds at any frame rate
constexpr int kPoll_ms = 200;

}  // namespace

ForeignOdometry::ForeignOdometry(std::string url)
    : url_(std::move(url)), thread_([this](const std::stop_token& stop) { receive(stop); }) {}

void ForeignOdometry::addOwn(const odometry_t& message) {
  own_.emplace_back(message.sequence, message.publication_utime);
  if (own_.size() > kMaxKept) own_.pop_front();
}

std::string ForeignOdometry::consumeProblem() {
  std::vector<Identity> received;
  std::size_t undecodable = 0;
  {
    const std::lock_guard lock(mutex_);
    received.swap(received_);
    undecodable = std::exchange(undecodable_, 0);
  }
  const auto foreign = std::count_if(received.begin(), received.end(), [this](const Identity& message) {
    return std::find(own_.begin(), own_.end(), message) == own_.end();
  });
  if (foreign > 0) {
    return std::string("another program publishes ") + kOdometryChannel +
           ": controllers receive two motions; stop the other cartvod or replay, or give one another lcm.url";
  }
  if (undecodable > 0) {
    return std::string("another program publishes ") + kOdometryChannel +
           " with another definition of the type, as another release of cartvod does; stop it, or give one "
           "another lcm.url";
  }
  return {};
}

void ForeignOdometry::receive(const std::stop_token& stop) {
  lcm::LCM lcm(url_);
  if (!lcm.good() || lcm.subscribe(kOdometryChannel, &ForeignOdometry::onData, this) == nullptr) {
    spdlog::debug("LCM: this host does not receive its own messages; other publishers are not looked for");
    return;
  }
  while (!stop.stop_requested()) {
    if (lcm.handleTimeout(kPoll_ms) < 0) return;
  }
}

void ForeignOdometry::onData(const lcm::ReceiveBuffer* buffer, const std::string& /*channel*/) {
  odometry_t message{};
  const auto bytes = static_cast<int>(buffer->data_size);
  const bool is_decoded = message.decode(buffer->data, 0, bytes) == bytes;
  const std::lock_guard lock(mutex_);
  if (!is_decoded) {
    ++undecodable_;
  } else if (received_.size() < kMaxKept) {
    received_.emplace_back(message.sequence, message.publication_utime);
  }
}

}  // namespace cartvo::daemon
