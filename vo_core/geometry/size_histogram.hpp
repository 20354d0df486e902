#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "common/statistics.hpp"

namespace cartvo::vo {

/// Histogram of error magnitudes over the leading bits of their floating-point numbers. It finds the median
/// of thousands of magnitudes, with a relative error of about a thousandth, without sorting them.
class SizeHistogram {
 public:
  void clear() {
    counts_.fill(0);
    count_ = 0;
  }

  /// Adds a magnitude, >= 0. Magnitudes below 2^-12 or above 2^12 count in the first or last bin.
  void add(double size) {
    ++counts_[std::clamp<std::int64_t>(std::bit_cast<std::int64_t>(size) >> kDroppedBits, kFirst,
                                       kFirst + kBins - 1) -
              kFirst];
    ++count_;
  }

  int count() const { return count_; }

  /// Robust estimate of the standard deviation, as stddevFromMedian(). Requires at least one magnitude.
  double stddev() const {
    const int rank = count_ / 2;  // rank of the median, the upper one of two
    int before = 0, bin = 0;
    while (before + counts_[bin] <= rank)
      before += counts_[bin++];
    const double share = (rank - before + 0.5) / counts_[bin];
    return (edge(bin) + share * (edge(bin + 1) - edge(bin))) / kMedianOfNormal;
  }

 private:
  // The bits of a positive double, read as an integer, grow with it: each bin is a 64th of the way to the
  // next power of two.
  static constexpr int kDroppedBits = 52 - 6;
  static constexpr std::int64_t kFirst = std::bit_cast<std::int64_t>(0x1p-12) >> kDroppedBits;
  static constexpr int kBins = 24 << 6;
  static double edge(int bin) { return std::bit_cast<double>((kFirst + bin) << kDroppedBits); }

  std::array<int, kBins> counts_{};
  int count_ = 0;
};

}  // namespace cartvo::vo
