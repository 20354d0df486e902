#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "vo_core/odometry_settings.hpp"

namespace cartvo {

/// What the command line and results call the estimators; cartvod's configuration uses the same names.
inline constexpr std::array<std::pair<Estimator, const char*>, 2> kEstimatorNames{
    {{Estimator::reprojection, "reprojection"}, {Estimator::thesis, "thesis"}}};

inline std::string estimatorName(Estimator estimator) {
  const auto named = std::find_if(kEstimatorNames.begin(), kEstimatorNames.end(),
                                  [&](const auto& entry) { return entry.first == estimator; });
  return named->second;
}

/// `name` must be one of `estimatorNames`.
inline Estimator estimatorNamed(const std::string& name) {
  const auto named = std::find_if(kEstimatorNames.begin(), kEstimatorNames.end(),
                                  [&](const auto& entry) { return name == entry.second; });
  return named->first;
}

inline std::vector<std::string> estimatorNames() {
  std::vector<std::string> names;
  for (const auto& [estimator, name] : kEstimatorNames)
    names.emplace_back(name);
  return names;
}

}  // namespace cartvo
