// Checks of LCM's network.
#include "tools/doctor/network/lcm_checks.hpp"

#include <exception>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>

#include <cartvo/odometry_t.hpp>
#include <fmt/format.h>
#include <lcm/lcm-cpp.hpp>
#include <unistd.h>

#include "common/host_clock.hpp"
#include "daemon/publish/lcm_connection.hpp"
#include "tools/watch/odometry_statistics.hpp"

namespace cartvo::doctor {
namespace {

constexpr const char* kRouteAdvice =
    "systemctl enable --now cartvo-multicast, or for other computers ttl=1 in lcm.url and the route of their "
    "network";

/// False if there is no route.
bool checkRoute(const std::string& url, FindingList& findings) {
  const daemon::MulticastRoute route = daemon::findMulticastRoute(url);
  if (route.interface.empty()) {
    findings.add("multicast route", Verdict::broken,
                 {"no route for " + route.address, "a route for the multicast group", kRouteAdvice});
    return false;
  }
  const std::string warning = daemon::multicastWarning(route);
  findings.add("multicast route", okIf(warning.empty(), Verdict::look_at),
               {route.address + " through " + route.interface + (warning.empty() ? "" : ": " + warning),
                "through lo with ttl=0, through a network with ttl=1", kRouteAdvice});
  return true;
}

void checkReturn(const LcmObservation& seen, FindingList& findings) {
  if (!seen.problem.empty()) {
    findings.add("own message", Verdict::broken,
                 {seen.problem, "LCM connects", "correct lcm.url and the route"});
    return;
  }
  findings.add("own message", okIf(seen.is_returned, Verdict::broken),
               {seen.is_returned ? "received back" : "not received back", "received back",
                "permit UDP multicast in the firewall, and see that the interface of the route is up with "
                "multicast on (ip link)"});
}

}  // namespace

void checkLcm(const std::string& url, const LcmObservation& seen, FindingList& findings) {
  if (!checkRoute(url, findings)) return;
  checkReturn(seen, findings);
  findings.add(
      "publishers", okIf(!seen.has_two_publishers && !seen.has_foreign_messages, Verdict::broken),
      {seen.has_two_publishers     ? "two programs publish CARTVO_ODOMETRY"
       : seen.has_foreign_messages ? "a program of another release publishes: its messages cannot be decoded"
       : seen.health               ? "one cartvod"
                                   : "no cartvod",
       "one cartvod at most, of this release",
       "stop one of them or give it another lcm.url; install one release on all computers"});
}

namespace {

constexpr const char* kDoctorChannel = "CARTVO_DOCTOR";

/// Receives in a thread of its own, which may live on while LCM tests the route.
class Listener {
 public:
  explicit Listener(std::string url)
      : url_(std::move(url)), token_(fmt::format("{} {}", ::getpid(), wallClockNow())) {}

  /// Runs until `stop`; for the thread.
  void run() noexcept {
    try {
      const std::unique_ptr<lcm::LCM> lcm = daemon::connectLcm(url_);
      lcm->subscribe(kDoctorChannel, &Listener::onOwn, this);
      lcm->subscribe(daemon::kOdometryChannel, &Listener::onOdometry, this);
      lcm->subscribe(daemon::kHealthChannel, &Listener::onHealth, this);
      lcm->publish(kDoctorChannel, token_.data(), static_cast<unsigned>(token_.size()));
      constexpr int kPoll_ms = 50;
      while (!stopped_ && lcm->handleTimeout(kPoll_ms) >= 0) {
      }
    } catch (const std::exception& error) {
      const std::lock_guard lock(mutex_);
      seen_.problem = error.what();
    }
  }

  void stop() { stopped_ = true; }

  LcmObservation seen() const {
    const std::lock_guard lock(mutex_);
    LcmObservation seen = seen_;
    seen.has_two_publishers = statistics_.hasTwoPublishers();
    return seen;
  }

 private:
  void onOwn(const lcm::ReceiveBuffer* buffer, const std::string& /*channel*/) {
    const std::string text(static_cast<const char*>(buffer->data), buffer->data_size);
    const std::lock_guard lock(mutex_);
    seen_.is_returned = seen_.is_returned || text == token_;
  }

  void onOdometry(const lcm::ReceiveBuffer* buffer, const std::string& /*channel*/) {
    odometry_t message{};
    const bool is_ours = decode(*buffer, message);
    const std::lock_guard lock(mutex_);
    seen_.has_foreign_messages = seen_.has_foreign_messages || !is_ours;
    ++seen_.odometry_messages;
    if (is_ours) statistics_.addMessage(message, wallClockNow());
  }

  void onHealth(const lcm::ReceiveBuffer* buffer, const std::string& /*channel*/) {
    health_t message{};
    const bool is_ours = decode(*buffer, message);
    const std::lock_guard lock(mutex_);
    seen_.has_foreign_messages = seen_.has_foreign_messages || !is_ours;
    if (is_ours) seen_.health = message;
  }

  /// False if the message is of another definition of the type.
  template <typename Message>
  static bool decode(const lcm::ReceiveBuffer& buffer, Message& message) {
    const auto bytes = static_cast<int>(buffer.data_size);
    return message.decode(buffer.data, 0, bytes) == bytes;
  }

  const std::string url_, token_;
  std::atomic<bool> stopped_{false};
  mutable std::mutex mutex_;
  LcmObservation seen_;
  OdometryStatistics statistics_;
};

}  // namespace

LcmObservation observeLcm(const std::string& url, std::chrono::milliseconds duration,
                          const std::atomic<bool>& interrupted) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::milliseconds kPause{20};
  const auto listener = std::make_shared<Listener>(url);
  std::thread([listener] { listener->run(); }).detach();
  const Clock::time_point end = Clock::now() + duration;
  LcmObservation seen = listener->seen();
  while (Clock::now() < end && !interrupted && seen.problem.empty() &&
         !(seen.is_returned && seen.health && seen.odometry_messages > 0)) {
    std::this_thread::sleep_for(kPause);
    seen = listener->seen();
  }
  listener->stop();
  return seen;
}

}  // namespace cartvo::doctor
