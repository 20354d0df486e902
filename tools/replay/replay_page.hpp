#pragma once

#include <cstddef>
#include <memory>
#include <string>

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
class ReplayPage {
 public:
  static constexpr std::size_t kMaxStoredBytes = 256'000'000;

  /// Throws what PageServer throws.
  explicit ReplayPage(const ReplayPageSettings& settings);
  ~ReplayPage();
  ReplayPage(const ReplayPage&) = delete;
  ReplayPage& operator=(const ReplayPage&) = delete;

  std::string url() const;

  /// Of the processor that makes the pairs.
  pipeline::PairViewer& viewer();

  /// Shows a pair, then waits for the recorded pace and while the page's user has paused. `expected`: pairs
  /// of the source, 0 if unknown.
  void addPair(const pipeline::PairResult& result, std::size_t expected);

  /// The last pair was added.
  void finish();

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo
