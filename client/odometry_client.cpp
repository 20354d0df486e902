// Receives odometry messages over LCM.

#include <algorithm>
#include <cstdlib>
#include <string>
#include <thread>

#include <cartvo/client.hpp>

namespace cartvo::client {
namespace {

constexpr int kMaxMessagesPerUpdate = 1000;  // a flood does not keep the control loop

}  // namespace

std::string defaultLcmUrl() {
  const char* url = std::getenv("LCM_DEFAULT_URL");
  return url == nullptr || *url == '\0' ? kDefaultLcmUrl : url;
}

OdometryClient::OdometryClient(lcm::LCM& lcm, const ControllerSettings& settings)
    : lcm_(lcm),
      subscription_(lcm.subscribe(kOdometryChannel, &OdometryClient::onData, this)),
      odometry_(settings) {}

OdometryClient::~OdometryClient() {
  if (subscription_ != nullptr) lcm_.unsubscribe(subscription_);
}

bool OdometryClient::update(int timeout_ms) {
  const SteadyClock::time_point end = SteadyClock::now() + std::chrono::milliseconds(timeout_ms);
  const std::uint64_t before = newest().kept();
  int left_ms = timeout_ms;
  int handled = 0;
  while (newest().kept() == before && handled < kMaxMessagesPerUpdate) {
    const int result = lcm_.handleTimeout(left_ms);
    if (result < 0) std::this_thread::sleep_until(end);
    if (result <= 0) return false;
    ++handled;
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - SteadyClock::now());
    left_ms = static_cast<int>(std::max<std::int64_t>(left.count(), 0));
  }
  while (handled < kMaxMessagesPerUpdate && lcm_.handleTimeout(0) > 0)
    ++handled;
  return newest().kept() != before;
}

void OdometryClient::onData(const lcm::ReceiveBuffer* buffer, const std::string& /*channel*/) {
  odometry_t message{};
  const auto bytes = static_cast<int>(buffer->data_size);
  if (message.decode(buffer->data, 0, bytes) != bytes) {
    ++undecodable_;
    return;
  }
  odometry_.add(message, nowUtime(), SteadyClock::now());
}

}  // namespace cartvo::client
