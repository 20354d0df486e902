// HTTP server with a thread pool, and the restrictions of its connections and requests.
#include "common/http/http_service.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <utility>

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "common/ascii_text.hpp"

namespace cartvo {
namespace {

bool wouldBlock() {
  return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
}

constexpr int kForbidden = 403, kNotFound = 404, kNotAllowed = 405;

/// Whether a Host header is a numeric address or localhost, with or without a port. It may be absent:
/// browsers always send it, monitors that speak HTTP/1.0 do not.
bool isAllowedHost(const std::string& header) {
  std::string host = lowerCase(header);
  if (host.empty()) return true;
  if (host.starts_with('[')) return isNumericAddress(host.substr(1, host.find(']') - 1));
  host = host.substr(0, host.find(':'));
  return host == "localhost" || isNumericAddress(host);
}

}  // namespace

BoundedStream::BoundedStream(int socket, const WakeEvent& stop, const std::atomic<std::size_t>& queued,
                             const HttpLimits& limits)
    : socket_(socket), stop_(stop), queued_(queued), limits_(limits), bytes_left_(limits.request_bytes) {}

BoundedStream::~BoundedStream() {
  shutdown(socket_, SHUT_RDWR);
  close(socket_);
}

bool BoundedStream::is_readable() const {
  return begin_ < end_ || wait(POLLIN, begin_time_, begin_time_ + limits_.request_time);
}

bool BoundedStream::is_writable() const {
  return wait(POLLOUT, Clock::now(), Clock::now() + limits_.answer_time);
}

/// Waits until the socket is ready. False at the deadline, while others are queued at `begin` and the time of
/// a crowd, and when the server stops.
bool BoundedStream::wait(short events, Clock::time_point begin, Clock::time_point deadline) const {
  using std::chrono::milliseconds;
  constexpr milliseconds kPeriod{20};  // of looking whether others are queued
  while (true) {
    const Clock::time_point end = queued_ > 0 ? std::min(deadline, begin + limits_.crowded_time) : deadline;
    const milliseconds left = std::chrono::ceil<milliseconds>(end - Clock::now());
    std::array<pollfd, 2> waiting{{{socket_, events, 0}, {stop_.descriptor(), POLLIN, 0}}};
    const int ready = poll(waiting.data(), waiting.size(),
                           static_cast<int>(std::clamp(left, milliseconds(0), kPeriod).count()));
    if (ready < 0 && errno != EINTR) return false;
    if (ready > 0) return waiting[1].revents == 0;
    if (left <= milliseconds(0)) return false;
  }
}

bool BoundedStream::fill() {
  while (bytes_left_ > 0 && wait(POLLIN, begin_time_, begin_time_ + limits_.request_time)) {
    const ssize_t received =
        recv(socket_, buffer_.data(), std::min(buffer_.size(), bytes_left_), MSG_DONTWAIT);
    if (received < 0 && wouldBlock()) continue;
    if (received <= 0) return false;
    begin_ = 0;
    end_ = static_cast<std::size_t>(received);
    bytes_left_ -= end_;
    return true;
  }
  return false;
}

ssize_t BoundedStream::read(char* data, std::size_t size) {
  if (begin_ == end_ && !fill()) return -1;
  const std::size_t count = std::min(size, end_ - begin_);
  std::memcpy(data, buffer_.data() + begin_, count);
  begin_ += count;
  return static_cast<ssize_t>(count);
}

ssize_t BoundedStream::write(const char* data, std::size_t size) {
  const Clock::time_point begin = Clock::now();
  if (answer_deadline_ == Clock::time_point{}) answer_deadline_ = begin + limits_.answer_time;
  while (true) {
    const ssize_t sent = send(socket_, data, size, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent >= 0) return sent;
    if (!wouldBlock() || !wait(POLLOUT, begin, answer_deadline_)) return -1;
  }
}

BoundedTaskQueue::BoundedTaskQueue(std::size_t threads, std::size_t max_queued_jobs,
                                   std::atomic<std::size_t>& queued)
    : max_queued_jobs_(max_queued_jobs), queued_(queued) {
  try {
    for (std::size_t i = 0; i < threads; ++i)
      threads_.emplace_back([this] { work(); });
  } catch (...) {
    BoundedTaskQueue::shutdown();
    throw;
  }
}

BoundedTaskQueue::~BoundedTaskQueue() {
  BoundedTaskQueue::shutdown();
}

void BoundedTaskQueue::enqueue(std::function<void()> job) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return jobs_.size() < max_queued_jobs_; });
  jobs_.push_back(std::move(job));
  queued_ = jobs_.size();
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
  threads_.clear();
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
      queued_ = jobs_.size();
    }
    changed_.notify_all();
    job();
  }
}

HttpService::HttpService(std::size_t threads, const HttpLimits& limits) : threads_(threads), limits_(limits) {
  using httplib::Request, httplib::Response;
  set_tcp_nodelay(true);
  set_socket_options([this](int socket) {  // the library's default shares the port with other programs
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    // Browsers open connections ahead of need: one without a request shall keep no thread.
    const int most_seconds = 10;
    setsockopt(socket, IPPROTO_TCP, TCP_DEFER_ACCEPT, &most_seconds, sizeof most_seconds);
    if (send_buffer_ > 0) setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &send_buffer_, sizeof send_buffer_);
  });
  set_pre_routing_handler([this](const Request& request, Response& response) {
    return refuse(request, response) ? HandlerResponse::Handled : HandlerResponse::Unhandled;
  });
  set_error_handler([](const Request&, Response& response) {
    if (!response.body.empty()) return;
    response.set_content(
        response.status == kNotFound ? "there is nothing at this path\n" : "the request cannot be answered\n",
        kPlainText);
  });
}

/// Answers a request that no handler may see; false: it may.
bool HttpService::refuse(const httplib::Request& request, httplib::Response& response) const {
  const bool takes_post = post_paths_.contains(request.path);
  const bool is_allowed =
      request.method == "GET" || request.method == "HEAD" || (takes_post && request.method == "POST");
  if (!is_allowed) {
    const std::string methods = takes_post ? "GET, HEAD, POST" : "GET, HEAD";
    response.status = kNotAllowed;
    response.set_header("Allow", methods);
    response.set_content("this path takes the methods " + methods + "\n", kPlainText);
    return true;
  }
  if (allows_any_host_ || isAllowedHost(request.get_header_value("Host"))) return false;
  response.status = kForbidden;
  response.set_content(
      "this server answers requests for a numeric address or localhost, so that no web site can read it "
      "through "
      "a browser; the header Host has a name. Behind a proxy, let it send 'Host: localhost'\n",
      kPlainText);
  return true;
}

HttpService::~HttpService() {
  if (!listener_.joinable()) return;
  stop_.wake();
  stop();
  listener_.join();
}

void HttpService::Post(const std::string& path, Handler handler) {
  post_paths_.insert(path);
  httplib::Server::Post(path, std::move(handler));
}

int HttpService::bind(const ListenAddress& address) {
  if (address.port == 0) return bind_to_any_port(address.address);
  return bind_to_port(address.address, address.port) ? address.port : -1;
}

void HttpService::start() {
  queue_ = std::make_unique<BoundedTaskQueue>(threads_, threads_, queued_);
  new_task_queue = [this] { return queue_.release(); };  // the library deletes it
  listener_ = std::thread([this] {
    listen_after_bind();
    has_ended_ = true;
  });
  while (!is_running() && !has_ended_)  // before, the library ignores stop()
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

bool HttpService::process_and_close_socket(socket_t socket) {
  BoundedStream stream(socket, stop_, queued_, limits_);
  bool connection_closed = false;
  const auto ignore_ranges = [](httplib::Request& request) {
    request.ranges.clear();  // thousands of ranges of one file are an answer without bound
  };
  return process_request(stream, true, connection_closed, ignore_ranges);
}

}  // namespace cartvo
