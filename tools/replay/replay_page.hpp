#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include <cartvo/health_t.hpp>
#include <cartvo/odometry_t.hpp>

#include "daemon/diagnostics/health_monitor.hpp"
#include "daemon/page/health_json.hpp"
#include "daemon/page/page_history.hpp"
#include "daemon/page/page_server.hpp"
#include "pipeline/pair_processor.hpp"

namespace cartvo {

/// Settings of the page of a replay.
struct ReplayPageSettings {
  daemon::PageServerSettings server;
  std::string title;  ///< of the source
  /// Factor on the recorded pace; 0: as fast as pairs are added, for a replay that something else paces.
  double speed = 1.0;
};

/// The status page of a replay (daemon::StatusPage), with pause and step. Keeps the frames of all pairs, up
/// to kMaxStoredBytes of the newest, so that a browser can show a pair again as it was processed; the
/// odometry does not run again for it.
class ReplayPage final : public daemon::PageContent, public pipeline::PairViewer {
 public:
  static constexpr std::size_t kMaxStoredBytes = 256'000'000;

  /// Throws what PageServer throws.
  explicit ReplayPage(const ReplayPageSettings& settings);

  std::string url() const { return server_.url(); }

  /// Of the processor that makes the pairs.
  pipeline::PairView* nextView() override { return &view_; }

  /// Shows a pair, then waits for the recorded pace and while the page's user has paused. `expected`: pairs
  /// of the source, 0 if unknown.
  void addPair(const pipeline::PairResult& result, std::size_t expected);

  /// The last pair was added.
  void finish();

  std::string about() override { return about_; }
  std::optional<std::string> newestFrame(std::uint64_t seen) override;
  std::optional<std::string> storedFrame(std::uint64_t pair) override;
  std::string history() override;
  std::string health() override;
  std::string control(const std::string& action) override;

 private:
  using Clock = std::chrono::steady_clock;
  enum class State : std::uint8_t { running, paused, ended };

  void store(const daemon::PageSample& sample);
  void updateHealth(const pipeline::PairResult& result, const odometry_t& message);
  void waitForPace(std::int64_t exposure_ns);
  daemon::ReplayState stateForPage() const;
  daemon::TrafficLight light() const;

  double speed_;
  std::string about_;
  pipeline::PairView view_;  ///< of the replaying thread, as are the next two
  daemon::HealthMonitor monitor_;
  Clock::time_point next_health_;

  std::mutex mutex_;  ///< for the following
  std::condition_variable changed_;
  State state_ = State::running;
  bool may_step_ = false;
  std::optional<std::pair<Clock::time_point, std::int64_t>> pace_;  ///< an instant and its exposure, ns
  daemon::PageHistory history_;
  health_t health_{};
  std::deque<std::string> frames_;
  std::size_t stored_bytes_ = 0;
  std::uint64_t first_ = 0;  ///< number of frames_.front()
  std::uint64_t total_ = 0;
  std::int32_t reasons_ = 0;  ///< of the newest pair
  bool is_valid_ = false;

  daemon::PageServer server_;  ///< last, because its threads use the others
};

}  // namespace cartvo
