// Resolution of host names within a deadline, by the system's resolver in a thread.

#include "capture/network/name_resolver.hpp"

#include <algorithm>
#include <cerrno>
#include <condition_variable>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

#include <netdb.h>
#include <netinet/in.h>

namespace cartvo::capture {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kInterruptionInterval{50};
constexpr std::size_t kMaxAddresses = 8;
constexpr std::chrono::seconds kMaxAnswerAge{30};  ///< an older answer is asked for again

/// Explains an error of getaddrinfo (`code`) and of the system (`system_error`) for a name.
std::string resolverErrorText(const std::string& host, int code, int system_error) {
  const std::string name = "the name '" + host + "' ";
  switch (code) {
    case EAI_AGAIN:
      return name + "cannot be resolved now (" + gai_strerror(code) +
             "): no name server answers; see /etc/resolv.conf and the network, or use the camera's address";
    case EAI_NONAME:
    case EAI_NODATA:
      return name + "is not known (" + gai_strerror(code) +
             "); correct it, enter it in /etc/hosts, or use the camera's address";
    case EAI_SYSTEM:
      return name + "cannot be resolved (" + std::strerror(system_error) + ")";
    default:
      return name + "cannot be resolved (" + gai_strerror(code) + "); use the camera's address";
  }
}

/// Asks the system's resolver, which may block.
ResolvedName askResolver(const std::string& host, const std::string& port, int flags) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = flags;
  addrinfo* found = nullptr;
  const int code = getaddrinfo(host.c_str(), port.c_str(), &hints, &found);
  const int system_error = errno;
  ResolvedName answer;
  if (code != 0) {
    answer.error = resolverErrorText(host, code, system_error);
    return answer;
  }
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> release(found, freeaddrinfo);
  for (const addrinfo* one = found; one != nullptr && answer.addresses.size() < kMaxAddresses;
       one = one->ai_next) {
    if ((one->ai_family != AF_INET && one->ai_family != AF_INET6) ||
        one->ai_addrlen > sizeof(sockaddr_storage))
      continue;
    ServerAddress address;
    address.size = one->ai_addrlen;
    std::memcpy(&address.address, one->ai_addr, one->ai_addrlen);
    answer.addresses.push_back(address);
  }
  if (answer.addresses.empty()) answer.error = resolverErrorText(host, EAI_NODATA, 0);
  return answer;
}

bool lacksInterface(const ServerAddress& address) {
  if (address.address.ss_family != AF_INET6) return false;
  const auto& ipv6 = reinterpret_cast<const sockaddr_in6&>(address.address);
  return IN6_IS_ADDR_LINKLOCAL(&ipv6.sin6_addr) && ipv6.sin6_scope_id == 0;
}

/// A look-up in its thread, which holds a reference of its own.
struct LookUp {
  std::mutex mutex;
  std::condition_variable finished;
  std::optional<ResolvedName> answer;
  Clock::time_point answered;
};

/// The look-ups whose answers were not taken yet, by host and port. Never destroyed: a thread may outlast
/// main().
struct LookUps {
  std::mutex mutex;
  std::map<std::pair<std::string, std::string>, std::shared_ptr<LookUp>> pending;
};

LookUps& lookUps() {
  static auto* const kLookUps = new LookUps;
  return *kLookUps;
}

/// The look-up under way for a host and port; begins one if there is none. Throws std::system_error if no
/// thread can be started.
std::shared_ptr<LookUp> joinLookUp(const std::string& host, const std::string& port) {
  LookUps& all = lookUps();
  const std::lock_guard lock(all.mutex);
  std::shared_ptr<LookUp>& entry = all.pending[{host, port}];
  if (entry) {
    const std::lock_guard entry_lock(entry->mutex);
    if (!entry->answer || Clock::now() - entry->answered < kMaxAnswerAge) return entry;
  }
  auto begun = std::make_shared<LookUp>();
  std::thread([look_up = begun, host, port] {
    ResolvedName answer = askResolver(host, port, 0);
    const std::lock_guard look_up_lock(look_up->mutex);
    look_up->answer = std::move(answer);
    look_up->answered = Clock::now();
    look_up->finished.notify_all();
  }).detach();
  entry = std::move(begun);
  return entry;
}

/// Forgets a look-up whose answer was taken, so that the next call asks again.
void forget(const std::string& host, const std::string& port, const std::shared_ptr<LookUp>& look_up) {
  LookUps& all = lookUps();
  const std::lock_guard lock(all.mutex);
  const auto found = all.pending.find({host, port});
  if (found != all.pending.end() && found->second == look_up) all.pending.erase(found);
}

}  // namespace

std::string ServerAddress::text() const {
  char text[NI_MAXHOST];
  const int error = getnameinfo(reinterpret_cast<const sockaddr*>(&address), size, text, sizeof text, nullptr,
                                0, NI_NUMERICHOST);
  return error == 0 ? text : "an unknown address";
}

ResolvedName resolveName(const std::string& host, const std::string& port, Clock::time_point deadline,
                         const std::atomic<bool>& interrupted) {
  ResolvedName numeric = askResolver(host, port, AI_NUMERICHOST | AI_NUMERICSERV);
  const bool is_ipv6 = host.find(':') != std::string::npos;
  if (numeric.error.empty() && lacksInterface(numeric.addresses.front())) {
    return {{},
            "the link-local address '" + host +
                "' needs the interface that leads to it, as in rtsp://[fe80::64%25eth1]:554/1"};
  }
  if (numeric.error.empty()) return numeric;
  if (is_ipv6) {
    return {{},
            "'" + host +
                "' is no IPv6 address, or what follows its '%' is no network interface of this computer"};
  }
  const Clock::time_point begin = Clock::now();
  std::shared_ptr<LookUp> look_up;
  try {
    look_up = joinLookUp(host, port);
  } catch (const std::system_error& error) {
    forget(host, port, nullptr);
    return {{}, "the name '" + host + "' cannot be resolved (no thread: " + error.what() + ")"};
  }
  std::unique_lock lock(look_up->mutex);
  while (!look_up->answer) {
    const Clock::time_point now = Clock::now();
    if (interrupted) return {{}, "interrupted"};
    if (now >= deadline) {
      const auto waited = std::chrono::duration_cast<std::chrono::milliseconds>(now - begin);
      return {{},
              "the name '" + host + "' was not resolved within " + std::to_string(waited.count()) +
                  " ms: no name server answers; see /etc/resolv.conf and the network, or use the camera's "
                  "address"};
    }
    look_up->finished.wait_until(lock, std::min(deadline, now + kInterruptionInterval));
  }
  ResolvedName answer = *look_up->answer;
  lock.unlock();
  forget(host, port, look_up);
  return answer;
}

}  // namespace cartvo::capture
