// Round values on the axes of plots.
#include "tools/report/axis.hpp"

#include <algorithm>
#include <cmath>

#include "tools/report/table.hpp"

namespace cartvo {

double roundStep(double range, int parts) {
  const double rough = std::max(range, 1e-9) / parts;
  const double decade = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * decade >= rough) return factor * decade;
  }
  return 10.0 * decade;
}

std::string tickLabel(double value, double step) {
  const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  return fixed(std::abs(value) < 1e-9 ? 0.0 : value, decimals);
}

}  // namespace cartvo
