#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/calibrate/plan/stereo_design.hpp"
#include "tools/report/drawing.hpp"
#include "tools/report/table.hpp"

namespace cartvo::calibrate {

/// Assumptions and ranges for the comparison of designs.
struct PlanSettings {
  double disparity_noise = 0.0;             ///< standard deviation, px
  std::optional<double> largest_disparity;  ///< px; nearer points are not matched; default: as cartvod
  double relative_error = 0.05;             ///< limit of the depth error relative to the range
  std::vector<double> ranges;               ///< m; at least one
};

/// A table with one row per design: nearest and farthest usable range, and the depth error at each range.
std::string planTable(const std::vector<StereoDesign>& designs, const PlanSettings& settings,
                      ReportFormat format);

/// The same as JSON, with all digits.
nlohmann::ordered_json planJson(const std::vector<StereoDesign>& designs, const PlanSettings& settings);

/// A drawing of the depth error and the overlap over the range, up to the largest of the ranges.
Drawing planPlot(const std::vector<StereoDesign>& designs, const PlanSettings& settings);

}  // namespace cartvo::calibrate
