#pragma once

#include <span>
#include <variant>

#include "vo_core/odometry_settings.hpp"

// The tuned constants of `estimator: reprojection`: the one list of their units, permitted ranges and
// sources. `lab/lab sensitivity` measures how much the results depend on each of them.

namespace cartvo::vo {

struct TunedConstant {
  const char* name;    ///< of its member of OdometrySettings: "tracking.levels"
  const char* unit;    ///< empty: a ratio, share or count
  double low, high;    ///< permitted range
  const char* source;  ///< derivation, paper or measurement of the default value
  std::variant<int*, double*> (*member)(OdometrySettings& settings);

  double value(const OdometrySettings& settings) const;
  /// Sets the value, rounded if it is an integer.
  void set(double value, OdometrySettings& settings) const;
  bool isInteger() const;
};

std::span<const TunedConstant> tunedConstants();

/// The limits of the product, which are requirements and not tuned: conditions of a valid motion, and the
/// calibration errors that are corrected.
std::span<const TunedConstant> productLimits();

}  // namespace cartvo::vo
