// HTTP server of the live calibration page.
#include "tools/calibrate/views/live_page.hpp"

#include <array>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include <arpa/inet.h>
#include <httplib.h>
#include <sys/socket.h>

#include "tools/calibrate/views/live_page_files.hpp"
#include "tools/calibrate/views/live_state.hpp"

namespace cartvo {
namespace {

using Clock = std::chrono::steady_clock;

/// Thread pool of the server with a bounded queue: further connections wait until there is room.
class BoundedTaskQueue : public httplib::TaskQueue {
 public:
  BoundedTaskQueue() {
    constexpr std::size_t kThreads = 6;  // the number of connections that a browser opens to one server
    for (std::size_t i = 0; i < kThreads; ++i)
      threads_.emplace_back([this] { work(); });
  }

  void enqueue(std::function<void()> job) override {
    constexpr std::size_t kMaxQueuedJobs = 16;
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return jobs_.size() < kMaxQueuedJobs; });
    jobs_.push_back(std::move(job));
    changed_.notify_all();
  }

  void shutdown() override {
    {
      const std::lock_guard lock(mutex_);
      is_over_ = true;
    }
    changed_.notify_all();
    for (std::thread& thread : threads_)
      thread.join();
  }

 private:
  void work() {
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

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> jobs_;
  std::vector<std::thread> threads_;
  bool is_over_ = false;
};

bool isAddress(int family, const std::string& text) {
  std::array<unsigned char, sizeof(in6_addr)> bytes{};
  return inet_pton(family, text.c_str(), bytes.data()) == 1;
}

/// Whether a Host header is a numeric address or localhost, with or without a port. Any other name could be
/// resolved to this server by its owner ("DNS rebinding").
bool isAllowedHost(std::string host) {
  if (host.starts_with('[')) return isAddress(AF_INET6, host.substr(1, host.find(']') - 1));
  host = host.substr(0, host.find(':'));
  return host == "localhost" || isAddress(AF_INET, host);
}

}  // namespace

PageAddress PageAddress::parse(const std::string& text) {
  PageAddress result;
  const std::size_t colon = text.rfind(':');
  const std::string port = colon == std::string::npos ? text : text.substr(colon + 1);
  if (colon != std::string::npos) {
    result.address = text.substr(0, colon);
    if (result.address.starts_with('[') && result.address.ends_with(']'))
      result.address = result.address.substr(1, result.address.size() - 2);
  }
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), result.port);
  if (error != std::errc() || end != port.data() + port.size() || port.empty() ||
      (!isAddress(AF_INET, result.address) && !isAddress(AF_INET6, result.address))) {
    throw std::invalid_argument("'" + text +
                                "' is neither PORT nor ADDRESS:PORT, such as 8600 or 0.0.0.0:8600");
  }
  return result;
}

bool PageAddress::isLoopback() const {
  return address == "::1" || (isAddress(AF_INET, address) && address.starts_with("127."));
}

struct LivePage::Implementation {
  /// A picture, encoded as JPEG at the first request.
  struct Picture {
    CameraPreview preview;
    std::string jpeg;
  };

  void update(const std::function<void()>& change) {
    const std::lock_guard lock(mutex);
    change();
    ++number;
  }

  std::string state() {
    const std::lock_guard lock(mutex);
    nlohmann::ordered_json json{
        {"board", board},
        {"number", number},
        {"stage", stage},
        {"has_pictures", !left.preview.image.empty() && !right.preview.image.empty()}};
    json.update(liveState(progress));
    if (stage == "done") {
      json["passed"] = passed;
      json["result"] = result;
      result_was_read = true;
    }
    last_request = Clock::now();
    state_read.notify_all();
    return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }

  std::string jpegOf(Picture& picture) {
    const std::lock_guard lock(mutex);
    if (picture.jpeg.empty()) picture.jpeg = liveJpeg(picture.preview);
    return picture.jpeg;
  }

  void route();
  void routePicture(const char* path, Picture& picture);

  std::mutex mutex;
  std::condition_variable state_read;
  std::string board;
  std::uint64_t number = 0;  ///< counts updates
  std::string stage = "views";
  StreamProgress progress;
  Picture left, right;
  bool passed = false;
  std::string result;
  bool result_was_read = false;
  Clock::time_point last_request;

  httplib::Server server;
  std::string url;
  std::thread listener;
};

void LivePage::Implementation::route() {
  using httplib::Request, httplib::Response;
  server.new_task_queue = [] { return new BoundedTaskQueue; };  // the server deletes it
  server.set_read_timeout(std::chrono::seconds(2));
  server.set_write_timeout(std::chrono::seconds(2));
  server.set_keep_alive_timeout(1);
  server.set_payload_max_length(1024);
  server.set_tcp_nodelay(true);
  server.set_socket_options([](int socket) {  // the library's default shares the port with other programs
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  server.set_default_headers({{"Cache-Control", "no-store"},
                              {"X-Content-Type-Options", "nosniff"},
                              {"X-Frame-Options", "DENY"},
                              {"Content-Security-Policy",
                               "default-src 'none'; script-src 'self'; connect-src 'self'; img-src 'self'; "
                               "style-src 'unsafe-inline'"}});
  server.set_pre_routing_handler([](const Request& request, Response& response) {
    if (request.method == "GET" && isAllowedHost(request.get_header_value("Host")))
      return httplib::Server::HandlerResponse::Unhandled;
    response.status = 403;
    return httplib::Server::HandlerResponse::Handled;
  });
  server.Get("/", [](const Request&, Response& response) {
    response.set_content(kLivePageHtml, "text/html; charset=utf-8");
  });
  server.Get("/page.js", [](const Request&, Response& response) {
    response.set_content(kLivePageScript, "text/javascript; charset=utf-8");
  });
  server.Get("/state.json", [this](const Request&, Response& response) {
    response.set_content(state(), "application/json");
  });
  routePicture("/left.jpg", left);
  routePicture("/right.jpg", right);
}

void LivePage::Implementation::routePicture(const char* path, Picture& picture) {
  server.Get(path, [this, &picture](const httplib::Request&, httplib::Response& response) {
    const std::string jpeg = jpegOf(picture);
    if (jpeg.empty()) {
      response.status = 404;
    } else {
      response.set_content(jpeg, "image/jpeg");
    }
  });
}

LivePage::LivePage(const PageAddress& address, const calib::BoardSpec& board)
    : implementation_(std::make_unique<Implementation>()) {
  Implementation& page = *implementation_;
  page.board = calib::boardSpecText(board);
  page.route();
  const int port = address.port == 0
                       ? page.server.bind_to_any_port(address.address)
                       : (page.server.bind_to_port(address.address, address.port) ? address.port : -1);
  const bool is_version_6 = address.address.find(':') != std::string::npos;
  const std::string host = is_version_6 ? "[" + address.address + "]" : address.address;
  if (port < 0) {
    throw std::runtime_error("the page cannot be served at " + host + ":" + std::to_string(address.port) +
                             ": is the port taken? Choose another with --page");
  }
  page.url = "http://" + host + ":" + std::to_string(port) + "/";
  page.listener = std::thread([&page] { page.server.listen_after_bind(); });
  while (!page.server.is_running())
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

LivePage::~LivePage() {
  implementation_->server.stop();
  implementation_->listener.join();
}

std::string LivePage::url() const {
  return implementation_->url;
}

void LivePage::show(const StreamProgress& progress) {
  implementation_->update([&] {
    implementation_->progress = progress;
    implementation_->left = {progress.left, {}};
    implementation_->right = {progress.right, {}};
  });
}

void LivePage::showSolving() {
  implementation_->update([&] { implementation_->stage = "solving"; });
}

void LivePage::showResult(bool passed, const std::string& text) {
  implementation_->update([&] {
    implementation_->stage = "done";
    implementation_->passed = passed;
    implementation_->result = text;
  });
  std::unique_lock lock(implementation_->mutex);
  if (Clock::now() - implementation_->last_request > std::chrono::seconds(5)) return;
  implementation_->state_read.wait_for(lock, std::chrono::seconds(2),
                                       [this] { return implementation_->result_was_read; });
}

}  // namespace cartvo
