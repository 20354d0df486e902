#pragma once

#include <string>

#include <cartvo/health_t.hpp>

#include "daemon/diagnostics/traffic_light.hpp"

namespace cartvo::daemon {

/// State of a recording, as the page tells it.
struct RecordingState {
  bool is_possible = false;  ///< whether one can be started
  bool is_recording = false;
  std::string folder;          ///< of this recording, or of the last one
  std::string text;            ///< why it is not possible, or why nothing is written; empty: in order
  std::uint64_t pictures = 0;  ///< written, of both cameras
  std::uint64_t bytes = 0;     ///< written
  std::uint64_t dropped_pictures = 0;
};

/// State of a replay, as the page tells it.
struct ReplayState {
  std::string state;        ///< "running", "paused" or "ended"
  std::uint64_t first = 0;  ///< stored pair with the lowest number
  std::uint64_t last = 0;   ///< newest pair
  std::uint64_t total = 0;  ///< pairs of the source; 0: unknown
};

/// Numbers and sentences of the health message as JSON members, such as "pairs":42; no braces around them.
std::string healthMembers(const health_t& health);
/// "light":{"state": lightName(), "cause": .., "topic": ..}
std::string lightMembers(const TrafficLight& light);
std::string recordingMembers(const RecordingState& recording);
std::string replayMembers(const ReplayState& replay);

/// A text as a JSON string.
std::string jsonText(const std::string& text);

}  // namespace cartvo::daemon
