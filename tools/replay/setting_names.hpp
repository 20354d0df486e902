#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "tools/replay/replay.hpp"
#include "vo_core/odometry_settings.hpp"

namespace cartvo {

/// Names of the estimators on the command line and in results, as in cartvod's configuration.
inline constexpr std::array<std::pair<vo::Estimator, const char*>, 2> kEstimatorNames{
    {{vo::Estimator::reprojection, "reprojection"}, {vo::Estimator::thesis, "thesis"}}};

/// Names of the choices for the online refinement of the rig calibration.
inline constexpr std::array<std::pair<vo::RigRefinement, const char*>, 2> kRigRefinementNames{
    {{vo::RigRefinement::off, "off"}, {vo::RigRefinement::correct, "correct"}}};

/// Names of the timestamp sources.
inline constexpr std::array<std::pair<ReplayClock, const char*>, 6> kReplayClockNames{
    {{ReplayClock::configured, "configured"},
     {ReplayClock::recorded, "recorded"},
     {ReplayClock::automatic, "auto"},
     {ReplayClock::ntp, "ntp"},
     {ReplayClock::arrival, "arrival"},
     {ReplayClock::visual, "visual"}}};

template <typename Names, typename Value>
std::string nameIn(const Names& names, Value value) {
  return std::find_if(names.begin(), names.end(), [&](const auto& entry) { return entry.first == value; })
      ->second;
}

template <typename Names>
auto valueIn(const Names& names, const std::string& name) {
  return std::find_if(names.begin(), names.end(), [&](const auto& entry) { return name == entry.second; })
      ->first;
}

template <typename Names>
std::vector<std::string> listOf(const Names& names) {
  std::vector<std::string> list;
  for (const auto& [value, name] : names)
    list.emplace_back(name);
  return list;
}

inline std::string estimatorName(vo::Estimator estimator) {
  return nameIn(kEstimatorNames, estimator);
}
/// `name` must be in `estimatorNames`.
inline vo::Estimator estimatorNamed(const std::string& name) {
  return valueIn(kEstimatorNames, name);
}
inline std::vector<std::string> estimatorNames() {
  return listOf(kEstimatorNames);
}

inline std::string rigRefinementName(vo::RigRefinement refinement) {
  return nameIn(kRigRefinementNames, refinement);
}
/// `name` must be in `rigRefinementNames`.
inline vo::RigRefinement rigRefinementNamed(const std::string& name) {
  return valueIn(kRigRefinementNames, name);
}
inline std::vector<std::string> rigRefinementNames() {
  return listOf(kRigRefinementNames);
}

inline std::string replayClockName(ReplayClock clock) {
  return nameIn(kReplayClockNames, clock);
}
/// `name` must be in `replayClockNames`.
inline ReplayClock replayClockNamed(const std::string& name) {
  return valueIn(kReplayClockNames, name);
}
inline std::vector<std::string> replayClockNames() {
  return listOf(kReplayClockNames);
}

}  // namespace cartvo
