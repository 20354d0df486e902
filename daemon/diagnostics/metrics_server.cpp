// HTTP server of the daemon's metrics.

#include "daemon/diagnostics/metrics_server.hpp"

#include <chrono>
#include <mutex>
#include <stdexcept>

#include "common/http/http_service.hpp"

namespace cartvo::daemon {
namespace {

using Clock = DaemonState::Clock;
constexpr std::size_t kServerThreads = 4;

}  // namespace

struct MetricsServer::Implementation {
  void noteMessage(const odometry_t& message) {
    state.last_message = Clock::now();
    state.reasons = message.reasons;
    if (message.status == odometry_t::VALID) state.last_valid = state.last_message;
  }
  void route();

  std::mutex mutex;  ///< for the next two
  DaemonState state;
  PairTotals totals;

  std::string address;
  HttpService server{kServerThreads};  ///< last, because its threads use the others
};

void MetricsServer::Implementation::route() {
  using httplib::Request, httplib::Response;
  server.Get("/metrics", [this](const Request&, Response& response) {
    std::unique_lock lock(mutex);
    const health_t health = state.health;
    const PairTotals current = totals;
    lock.unlock();
    response.set_content(metricsText(health, current), "text/plain; version=0.0.4; charset=utf-8");
  });
  const auto answer_by = [this](HealthAnswer (*decide)(const DaemonState&, Clock::time_point)) {
    return [this, decide](const Request&, Response& response) {
      std::unique_lock lock(mutex);
      const DaemonState current = state;
      lock.unlock();
      const HealthAnswer answer = decide(current, Clock::now());
      response.status = answer.is_healthy ? 200 : 503;
      response.set_content(answer.line + "\n", kPlainText);
    };
  };
  server.Get("/healthz", answer_by(healthAnswer));
  server.Get("/readyz", answer_by(readyAnswer));
  server.Get("/livez",
             [](const Request&, Response& response) { response.set_content("alive\n", kPlainText); });
}

MetricsServer::MetricsServer(const ListenAddress& address)
    : implementation_(std::make_unique<Implementation>()) {
  Implementation& server = *implementation_;
  server.state.last_message = Clock::now();
  server.state.last_valid = server.state.last_message - std::chrono::hours(1);
  server.route();
  const int port = server.server.bind(address);
  if (port < 0) {
    throw std::runtime_error("metrics.listen: cannot listen at " + address.text() +
                             ": is the port taken, or the address not one of this computer? As a service, "
                             "another port than 9464 needs SocketBindAllow=");
  }
  server.address = ListenAddress{address.address, static_cast<std::uint16_t>(port)}.text();
  server.server.start();
}

MetricsServer::~MetricsServer() = default;

const std::string& MetricsServer::address() const {
  return implementation_->address;
}

void MetricsServer::addPair(const pipeline::PairResult& result, const odometry_t& message) {
  const std::lock_guard lock(implementation_->mutex);
  implementation_->totals.add(result, message);
  implementation_->noteMessage(message);
}

void MetricsServer::addMissedPair(const odometry_t& message) {
  const std::lock_guard lock(implementation_->mutex);
  implementation_->noteMessage(message);
}

void MetricsServer::setStalled(const std::string& stalled) {
  const std::lock_guard lock(implementation_->mutex);
  implementation_->state.stalled = stalled;
}

void MetricsServer::setHealth(const health_t& health) {
  const std::lock_guard lock(implementation_->mutex);
  implementation_->state.health = health;
}

}  // namespace cartvo::daemon
