#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include <httplib.h>

#include "common/http/listen_address.hpp"

// What the small HTTP servers share. Library cartvo_http. Include it after Eigen: <resolv.h>, which httplib
// includes, defines the macro _res.

namespace cartvo {

/// Thread pool of a server with a bounded queue: further connections wait until there is room.
class BoundedTaskQueue : public httplib::TaskQueue {
 public:
  BoundedTaskQueue(std::size_t threads, std::size_t max_queued_jobs);

  void enqueue(std::function<void()> job) override;
  void shutdown() override;

 private:
  void work();

  std::size_t max_queued_jobs_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> jobs_;
  std::vector<std::thread> threads_;
  bool is_over_ = false;
};

/// Makes `server` answer only GET requests whose Host header is a numeric address or localhost, so that no
/// other site can make a browser read it ("DNS rebinding"). Keeps the port from being shared with other
/// programs. Bounds requests in time and size, and clients by `threads` and as many again that wait.
void restrictServer(httplib::Server& server, std::size_t threads);

/// Binds `server` and returns the port; -1 if that fails, for example because the port is taken.
int bindServer(httplib::Server& server, const ListenAddress& address);

}  // namespace cartvo
