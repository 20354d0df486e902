#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "vo_core/median.hpp"

namespace cartvo {

/// Sizes of errors, counted by their leading digits: of thousands, the median to a thousandth of itself in
/// the time that it takes to write them down.
class SizeHistogram {
 public:
  void clear() {
    counts_.fill(0);
    count_ = 0;
  }

  /// `size` >= 0; what is below 2^-12 or above 2^12 is known no better.
  void add(double size) {
    ++counts_[std::clamp<std::int64_t>(std::bit_cast<std::int64_t>(size) >> kDropped, kFirst,
                                       kFirst + kBins - 1) -
              kFirst];
    ++count_;
  }

  int count() const { return count_; }

  /// As deviationOf(), of some sizes at least.
  double deviation() const {
    const int rank = count_ / 2;  // of the median: the upper one of two
    int before = 0, bin = 0;
    while (before + counts_[bin] <= rank)
      before += counts_[bin++];
    const double share = (rank - before + 0.5) / counts_[bin];
    return (edge(bin) + share * (edge(bin + 1) - edge(bin))) / kMedianOfNormal;
  }

 private:
  // A double's bits, read as a number, grow with it: each bin is a 64th of the way to the next power of two.
  static constexpr int kDropped = 52 - 6;
  static constexpr std::int64_t kFirst = std::bit_cast<std::int64_t>(0x1p-12) >> kDropped;
  static constexpr int kBins = 24 << 6;
  static double edge(int bin) { return std::bit_cast<double>((kFirst + bin) << kDropped); }

  std::array<int, kBins> counts_{};
  int count_ = 0;
};

}  // namespace cartvo
