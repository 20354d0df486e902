// Finds other programs that publish odometry on the daemon's channel, and reserves it.
#include "daemon/publish/foreign_odometry.hpp"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <stdexcept>
#include <system_error>

#include <cartvo/odometry_t.hpp>
#include <lcm/lcm-cpp.hpp>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "daemon/publish/lcm_connection.hpp"
#include "daemon/publish/lcm_url.hpp"

namespace cartvo::daemon {
namespace {

constexpr int kPoll_ms = 200;
// Another daemon sends at least every 0.5 s, whether its cameras send or not.
constexpr std::chrono::milliseconds kListening{550};
constexpr std::chrono::milliseconds kMaxTest{1000};  // by then LCM's test is over, unless nothing comes back
using Clock = std::chrono::steady_clock;

struct AbstractName {
  sockaddr_un address{};
  socklen_t size = 0;

  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&address); }
};

AbstractName nameOf(const std::string& url) {
  const std::string text = std::string("cartvo/") + kOdometryChannel + "@" + parseLcmUrl(url).text();
  AbstractName name;
  name.address.sun_family = AF_UNIX;
  const std::size_t length = std::min(text.size(), sizeof name.address.sun_path - 1);
  text.copy(name.address.sun_path + 1, length);  // an abstract name begins with a zero
  name.size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + length);
  return name;
}

int openSocket() {
  const int descriptor = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (descriptor < 0) throw std::system_error(errno, std::generic_category(), "cannot open a socket");
  return descriptor;
}

/// " (process 123)"; empty if the process is not known.
std::string ownerText(const AbstractName& name) {
  const int descriptor = openSocket();
  ucred owner{};
  socklen_t size = sizeof owner;
  const bool is_known = connect(descriptor, name.get(), name.size) == 0 &&
                        getsockopt(descriptor, SOL_SOCKET, SO_PEERCRED, &owner, &size) == 0 && owner.pid > 0;
  close(descriptor);
  return is_known ? " (process " + std::to_string(owner.pid) + ")" : "";
}

}  // namespace

/// State of the receiving thread. Owned by both sides: the thread may outlive the daemon for the seconds of
/// LCM's test.
struct ForeignOdometry::Receiver {
  explicit Receiver(std::int64_t source_id) : own_source_id(source_id) {}
  void run(const std::string& url) {
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
  void onData(const lcm::ReceiveBuffer* buffer, const std::string& /*channel*/) {
    odometry_t message{};
    const auto bytes = static_cast<int>(buffer->data_size);
    if (message.decode(buffer->data, 0, bytes) != bytes) {
      has_undecodable = true;
    } else if (message.source_id != own_source_id) {
      has_foreign = true;
    }
  }

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

ChannelReservation::ChannelReservation(const std::string& url) : socket_(openSocket()) {
  const AbstractName name = nameOf(url);
  if (bind(socket_, name.get(), name.size) == 0 && listen(socket_, 1) == 0) return;
  const int error = errno;
  close(socket_);
  if (error != EADDRINUSE)
    throw std::system_error(error, std::generic_category(), "cannot reserve the odometry channel");
  throw std::runtime_error("another cartvod" + ownerText(name) + " publishes " + kOdometryChannel + " on " +
                           url +
                           ": controllers would receive two motions; stop it ('systemctl stop cartvod' if it "
                           "is the service), or give one another lcm.url");
}

ChannelReservation::~ChannelReservation() {
  close(socket_);
}

}  // namespace cartvo::daemon
