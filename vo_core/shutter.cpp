// Instants of rectified pixels under a rolling shutter.
#include "vo_core/shutter.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/exact_text.hpp"

namespace cartvo::vo {
namespace {

constexpr double kLongestReadout = 0.2;  // s: a frame period at 5 Hz

void require(bool sensible, const char* name, double value, const char* expected) {
  if (sensible) return;
  throw std::invalid_argument(std::string(name) + " is " + roundedText(value) + " s: expected " + expected);
}

void validate(const Shutter& shutter, const char* readout, const char* stddev) {
  require(std::abs(shutter.readout) <= kLongestReadout, readout, shutter.readout, "-0.2 to 0.2 s");
  require(shutter.readout_stddev >= 0.0 && shutter.readout_stddev <= kLongestReadout, stddev,
          shutter.readout_stddev, "0 to 0.2 s");
}

}  // namespace

RowShares::RowShares(int columns, std::vector<float> nodes) : columns_(columns), nodes_(std::move(nodes)) {
  if (columns < 2 || nodes_.size() % static_cast<std::size_t>(columns) != 0 ||
      nodes_.size() < 2 * static_cast<std::size_t>(columns))
    throw std::invalid_argument("row shares: " + std::to_string(nodes_.size()) + " nodes in " +
                                std::to_string(columns) + " columns: expected full rows, two at least");
  rows_ = static_cast<int>(nodes_.size()) / columns;
}

double RowShares::at(const Eigen::Vector2d& pixel, int height) const {
  if (columns_ == 0) return std::clamp((pixel.y() + 0.5) / height, 0.0, 1.0) - 0.5;
  const double x = std::clamp(pixel.x() / kStep, 0.0, columns_ - 1.0);
  const double y = std::clamp(pixel.y() / kStep, 0.0, rows_ - 1.0);
  const int column = std::min(static_cast<int>(x), columns_ - 2);
  const int row = std::min(static_cast<int>(y), rows_ - 2);
  const double right = x - column, lower = y - row;
  const float* upper_nodes = nodes_.data() + static_cast<std::size_t>(row) * columns_ + column;
  const float* lower_nodes = upper_nodes + columns_;
  return (1.0 - lower) * ((1.0 - right) * upper_nodes[0] + right * upper_nodes[1]) +
         lower * ((1.0 - right) * lower_nodes[0] + right * lower_nodes[1]);
}

void validate(const StereoShutters& shutters) {
  validate(shutters.left, "readout of the left camera", "stddev of the left camera's readout");
  validate(shutters.right, "readout of the right camera", "stddev of the right camera's readout");
}

}  // namespace cartvo::vo
