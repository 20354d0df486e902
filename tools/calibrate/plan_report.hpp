#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/calibrate/stereo_design.hpp"
#include "tools/report/table.hpp"

namespace cartvo::calibrate {

/// What is asked of each design.
struct PlanQuestions {
  double disparity_noise = 0.0;    ///< standard deviation, px
  double largest_disparity = 0.0;  ///< px; what is nearer is not matched
  double relative_error = 0.05;    ///< of the range, up to which depths count as good
  std::vector<double> ranges;      ///< m; at least one
};

/// A row for each design: how near and far it measures, and how well at each range.
std::string planTable(const std::vector<StereoDesign>& designs, const PlanQuestions& questions,
                      ReportFormat format);

/// The same with all digits.
nlohmann::ordered_json planJson(const std::vector<StereoDesign>& designs, const PlanQuestions& questions);

/// An SVG of the depth's error over the range, up to the largest one asked for, and of the overlap.
std::string planPlot(const std::vector<StereoDesign>& designs, const PlanQuestions& questions);

}  // namespace cartvo::calibrate
