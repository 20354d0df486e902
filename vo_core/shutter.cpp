// Instants of rectified pixels under a rolling shutter.
#include "vo_core/shutter.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace cartvo::vo {
namespace {

constexpr double kLongestReadout = 0.2;  // s: a frame period at 5 Hz

void require(bool sensible, const char* name, double value, const char* expected) {
  if (sensible) return;
  std::ostringstream message;
  message << name << " is " << value << " s: expected " << expected;
  throw std::invalid_argument(message.str());
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

void validate(const StereoShutters& shutters) {
  validate(shutters.left, "readout of the left camera", "stddev of the left camera's readout");
  validate(shutters.right, "readout of the right camera", "stddev of the right camera's readout");
}

}  // namespace cartvo::vo
