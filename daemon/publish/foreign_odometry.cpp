// Finds other programs that publish odometry on the daemon's channel.
#include "daemon/publish/foreign_odometry.hpp"

#include <cartvo/odometry_t.hpp>
#include <lcm/lcm-cpp.hpp>

#include "daemon/publish/lcm_connection.hpp"
#include "daemon/publish/lcm_url.hpp"

namespace cartvo::daemon {
namespace {

constexpr int kPoll_ms = 200;
// Another daemon sends at least every 0.5 s, whether its cameras send or not.
constexpr std::chrono::milliseconds kListening{550};
constexpr std::chrono::milliseconds kMaxTest{1000};  // by then LCM's test is over, unless nothing comes back
using Clock = std::chrono::steady_clock;

}  // namespace

/// State of the receiving thread. Owned by both sides: the thread may outlive the daemon for the seconds of
/// LCM's test.
struct ForeignOdometry::Receiver {
  explicit Receiver(std::int64_t source_id) : own_source_id(source_id) {}
  void run(const std::string& url);
  void onData(const lcm::ReceiveBuffer* buffer, const std::string& channel);

  std::atomic<bool> stopped = false;
  std::atomic<bool> tested = false;  ///< LCM's test is over
  std::atomic<Clock::time_point> receiving_since{};
  std::atomic<bool> has_foreign = false;  ///< since the last consumeProblem, as is the next
  std::atomic<bool> has_undecodable = false;
  const std::int64_t own_source_id;
};

ForeignOdometry::ForeignOdometry(const std::string& url, std::int64_t own_source_id)
    : begin_(Clock::now()),
      receiver_(std::make_shared<Receiver>(own_source_id)),
      thread_([receiver = receiver_, url] { receiver->run(url); }) {}

ForeignOdometry::~ForeignOdometry() {
  receiver_->stopped = true;
  if (receiver_->tested) {
    thread_.join();
  } else {
    thread_.detach();
  }
}

bool ForeignOdometry::hasListened() const {
  const Clock::time_point now = Clock::now();
  if (!receiver_->tested) return now - begin_ > kMaxTest;
  return now - receiver_->receiving_since.load() > kListening;
}

std::string ForeignOdometry::consumeProblem() {
  const bool has_foreign = receiver_->has_foreign.exchange(false);
  const bool has_undecodable = receiver_->has_undecodable.exchange(false);
  if (has_foreign) {
    return std::string("another program publishes ") + kOdometryChannel +
           ": controllers receive two motions; stop the other cartvod or replay, or give one another lcm.url";
  }
  if (has_undecodable) {
    return std::string("another program publishes ") + kOdometryChannel +
           " with another definition of the type, as another release of cartvod does; stop it, or give one "
           "another lcm.url";
  }
  return {};
}

void ForeignOdometry::Receiver::run(const std::string& url) {
  lcm::LCM lcm(parseLcmUrl(url).url());
  if (!lcm.good()) return;
  lcm.subscribe(kOdometryChannel, &Receiver::onData, this);
  // Without a descriptor, as after a test that failed, LCM's handleTimeout aborts the process.
  const bool receives = !stopped && lcm.getFileno() >= 0;
  receiving_since = Clock::now();
  tested = true;
  while (receives && !stopped) {
    if (lcm.handleTimeout(kPoll_ms) < 0) return;
  }
}

void ForeignOdometry::Receiver::onData(const lcm::ReceiveBuffer* buffer, const std::string& /*channel*/) {
  odometry_t message{};
  const auto bytes = static_cast<int>(buffer->data_size);
  if (message.decode(buffer->data, 0, bytes) != bytes) {
    has_undecodable = true;
  } else if (message.source_id != own_source_id) {
    has_foreign = true;
  }
}

}  // namespace cartvo::daemon
