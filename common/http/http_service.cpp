// Thread pool and restrictions of HTTP servers.
#include "common/http/http_service.hpp"

#include <chrono>
#include <utility>

#include <sys/socket.h>

namespace cartvo {
namespace {

/// Whether a Host header is a numeric address or localhost, with or without a port.
bool isAllowedHost(std::string host) {
  if (host.starts_with('[')) return isNumericAddress(host.substr(1, host.find(']') - 1));
  host = host.substr(0, host.find(':'));
  return host == "localhost" || isNumericAddress(host);
}

}  // namespace

BoundedTaskQueue::BoundedTaskQueue(std::size_t threads, std::size_t max_queued_jobs)
    : max_queued_jobs_(max_queued_jobs) {
  for (std::size_t i = 0; i < threads; ++i)
    threads_.emplace_back([this] { work(); });
}

void BoundedTaskQueue::enqueue(std::function<void()> job) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return jobs_.size() < max_queued_jobs_; });
  jobs_.push_back(std::move(job));
  changed_.notify_all();
}

void BoundedTaskQueue::shutdown() {
  {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_)
    thread.join();
}

void BoundedTaskQueue::work() {
  while (true) {
    std::function<void()> job;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return !jobs_.empty() || is_over_; });
      if (jobs_.empty()) return;
      job = std::move(jobs_.front());
      jobs_.pop_front();
    }
    changed_.notify_all();
    job();
  }
}

void restrictServer(httplib::Server& server, std::size_t threads) {
  using httplib::Request, httplib::Response;
  server.new_task_queue = [threads] {  // the server deletes it
    return new BoundedTaskQueue(threads, threads);
  };
  server.set_read_timeout(std::chrono::seconds(2));
  server.set_write_timeout(std::chrono::seconds(2));
  server.set_keep_alive_timeout(1);
  server.set_payload_max_length(1024);
  server.set_tcp_nodelay(true);
  server.set_socket_options([](int socket) {  // the library's default shares the port with other programs
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  server.set_pre_routing_handler([](const Request& request, Response& response) {
    if (request.method == "GET" && isAllowedHost(request.get_header_value("Host")))
      return httplib::Server::HandlerResponse::Unhandled;
    response.status = 403;
    return httplib::Server::HandlerResponse::Handled;
  });
}

int bindServer(httplib::Server& server, const ListenAddress& address) {
  if (address.port == 0) return server.bind_to_any_port(address.address);
  return server.bind_to_port(address.address, address.port) ? address.port : -1;
}

}  // namespace cartvo
