// Numbers as text that reads back to the same double.
#include "common/exact_text.hpp"

#include <cstdio>

namespace cartvo {

std::string exactText(double value) {
  char text[32];
  for (int digits = 6; digits <= 17; ++digits) {
    std::snprintf(text, sizeof text, "%.*g", digits, value);
    if (std::stod(text) == value) break;
  }
  return text;
}

std::string exactText(const std::vector<double>& values) {
  std::string text = "[";
  for (const double value : values)
    text += (text.size() > 1 ? ", " : "") + exactText(value);
  return text + "]";
}

}  // namespace cartvo
