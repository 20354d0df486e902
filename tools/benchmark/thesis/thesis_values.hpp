#pragma once

#include <optional>

#include "vo_core/stage_observer.hpp"

namespace cartvo::benchmark {

// Values of V. Venkatachalapathy, "Visual Odometry Estimation Using Selective Features", RIT, 2016. The
// values of Tables 5-3 to 5-7 and of Figures 4-13 and 4-14 are not available.

// Table 5-1.
inline constexpr double kThesisDepthRSquared = 0.9977;
inline constexpr double kThesisDepthRSquaredWholePixels = 0.9859;
inline constexpr double kThesisMatchGain = 0.086;

// Table 5-2: 1241x376, on the machine of the thesis, ms.
inline constexpr double kThesisTotal1000Ms = 25.91;
inline constexpr double kThesisTotal9600Ms = 61.2;

/// Time of one stage with 1,000 features, ms; nothing for stages that the thesis does not have.
constexpr std::optional<double> thesisStageMs(vo::Stage stage) {
  switch (stage) {
    case vo::Stage::rectify:
      return 9.98;
    case vo::Stage::pyramid:
      return 8.56;
    case vo::Stage::optical_flow:
      return 1.21;
    case vo::Stage::disparity:
      return 2.12;
    case vo::Stage::reproject:
      return 0.28;
    case vo::Stage::motion:
      return 0.60;
    case vo::Stage::detect:
      return 1.91;
    case vo::Stage::weights:
      return 0.80;
    case vo::Stage::minimum_distance:
      return 0.09;
    default:
      return std::nullopt;
  }
}

}  // namespace cartvo::benchmark
