// Finds other programs that publish odometry on the daemon's channel.
#include "daemon/publish/foreign_odometry.hpp"

#include <algorithm>

#include <lcm/lcm-cpp.hpp>

#include "daemon/publish/lcm_connection.hpp"

namespace cartvo::daemon {
namespace {

constexpr std::size_t kMaxKept = 1000;  // messages; several seconds at any frame rate
constexpr int kPoll_ms = 200;
// Another daemon sends at least every 0.5 s, whether its cameras send or not.
constexpr std::chrono::milliseconds kListening{550};
constexpr std::chrono::milliseconds kMaxTest{1000};  // by then LCM's test is over, unless nothing comes back
using Clock = std::chrono::steady_clock;

}  // namespace

/// What the thread receives. Owned by both sides: the thread may outlive the daemon for the seconds of LCM's
/// test.
struct ForeignOdometry::Receiver {
  void run(const std::string& url);
  void onData(const lcm::ReceiveBuffer* buffer, const std::string& channel);

  std::atomic<bool> stopped = false;
  std::atomic<bool> tested = false;  ///< LCM's test is over
  std::atomic<Clock::time_point> receiving_since{};
  std::mutex mutex;  ///< guards the following
  std::vector<Identity> received;
  std::size_t undecodable = 0;
};

ForeignOdometry::ForeignOdometry(const std::string& url)
    : begin_(Clock::now()),
      receiver_(std::make_shared<Receiver>()),
      thread_([receiver = receiver_, url] { receiver->run(url); }) {}

ForeignOdometry::~ForeignOdometry() {
  receiver_->stopped = true;
  if (receiver_->tested) {
    thread_.join();
  } else {
    thread_.detach();
  }
}

void ForeignOdometry::addOwn(const odometry_t& message) {
  own_.emplace_back(message.sequence, message.publication_utime);
  if (own_.size() > kMaxKept) own_.pop_front();
}

bool ForeignOdometry::hasListened() const {
  const Clock::time_point now = Clock::now();
  if (!receiver_->tested) return now - begin_ > kMaxTest;
  return now - receiver_->receiving_since.load() > kListening;
}

std::string ForeignOdometry::consumeProblem() {
  std::vector<Identity> received;
  std::size_t undecodable = 0;
  {
    const std::lock_guard lock(receiver_->mutex);
    received.swap(receiver_->received);
    undecodable = std::exchange(receiver_->undecodable, 0);
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

void ForeignOdometry::Receiver::run(const std::string& url) {
  lcm::LCM lcm(url);
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
  const bool is_decoded = message.decode(buffer->data, 0, bytes) == bytes;
  const std::lock_guard lock(mutex);
  if (!is_decoded) {
    ++undecodable;
  } else if (received.size() < kMaxKept) {
    received.emplace_back(message.sequence, message.publication_utime);
  }
}

}  // namespace cartvo::daemon
