// The reservation is a listening socket with an abstract name (unix(7)): the kernel frees the name when the
// process ends, so that nothing is left over by one that was killed.
#include "daemon/publish/channel_reservation.hpp"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <stdexcept>
#include <system_error>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "daemon/publish/lcm_connection.hpp"
#include "daemon/publish/lcm_url.hpp"

namespace cartvo::daemon {
namespace {

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
