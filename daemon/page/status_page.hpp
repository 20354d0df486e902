#pragma once

#include <functional>
#include <memory>
#include <string>

#include <cartvo/health_t.hpp>
#include <cartvo/odometry_t.hpp>

#include "daemon/page/health_json.hpp"
#include "daemon/page/page_server.hpp"
#include "pipeline/pair_processor.hpp"

namespace cartvo::daemon {

/// Functions of the page's recording buttons. May be empty. Called by the page's threads.
struct RecordingControl {
  std::function<std::string()> start;  ///< returns why it was not started; empty: it was
  std::function<std::string()> stop;
};

/// JSON of PageContent::about(). `mode`: "live" or "replay". `title`: the rig's name or the replay's source.
std::string aboutJson(const std::string& mode, const std::string& title);

/// The status page of a running daemon. The odometry's thread never waits for it: numbers go through a queue
/// without locks, and pictures, only while a browser asks for them and ten times a second, through a mailbox.
/// A thread of low priority encodes each picture once for all viewers.
class StatusPage {
 public:
  /// Throws what PageServer throws.
  StatusPage(const PageServerSettings& settings, const std::string& title, RecordingControl recording);
  ~StatusPage();
  StatusPage(const StatusPage&) = delete;
  StatusPage& operator=(const StatusPage&) = delete;

  std::string url() const;

  // Called by the odometry's thread.

  pipeline::PairViewer& viewer();
  void addPair(const pipeline::PairResult& result, const odometry_t& message);
  void addMissedPair(const odometry_t& message);
  void setStalled(const std::string& stalled);  ///< as PipelineProgress::stalledReader()
  void setHealth(const health_t& health, const RecordingState& recording);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo::daemon
