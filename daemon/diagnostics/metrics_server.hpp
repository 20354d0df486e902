#pragma once

#include <memory>
#include <string>

#include "common/http/listen_address.hpp"
#include "daemon/diagnostics/metrics.hpp"

namespace cartvo::daemon {

/// Serves /metrics (Prometheus), /healthz, /readyz and /livez over HTTP, with threads of its own: the
/// odometry's thread only copies numbers under a lock, whatever clients do. At most four clients are served
/// at a time, the next wait; one whose request is not complete after two seconds is disconnected. See
/// HttpService for the requests that are answered.
class MetricsServer {
 public:
  /// Throws std::runtime_error if it cannot listen at the address or start threads.
  explicit MetricsServer(const ListenAddress& address);
  ~MetricsServer();
  MetricsServer(const MetricsServer&) = delete;
  MetricsServer& operator=(const MetricsServer&) = delete;

  /// Where it listens, such as "127.0.0.1:9464".
  const std::string& address() const;

  // Called by the odometry's thread.

  void addPair(const pipeline::PairResult& result, const odometry_t& message);
  void addMissedPair(const odometry_t& message);
  void setStalled(const std::string& stalled);
  void setHealth(const health_t& health);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo::daemon
