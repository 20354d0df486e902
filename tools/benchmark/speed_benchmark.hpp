#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <vector>

#include <opencv2/core/types.hpp>

#include "tools/benchmark/accuracy_benchmark.hpp"
#include "tools/benchmark/reference_work.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/stage_observer.hpp"

namespace cartvo::benchmark {

/// What is timed: each size with each number of features on each number of threads.
struct SpeedSettings {
  std::vector<cv::Size> sizes;
  std::vector<int> features;
  std::vector<int> threads;
  OdometrySettings odometry;  ///< but for the features
  int pairs = 24;             ///< of the drive, at least kWarmUp + 2
  int repeats = 3;            ///< of it, each with an odometry that begins anew
  int rendering_threads = 2;
  std::filesystem::path cache;  ///< for rendered worlds
};

/// Pairs at the beginning of each repeat that are not counted: the odometry fills its window and its memory.
inline constexpr int kWarmUp = 4;

/// Of some times, ms.
struct Distribution {
  double median = 0.0;
  double p99 = 0.0;
  double maximum = 0.0;
};

/// `milliseconds` must not be empty.
Distribution distributionOf(const std::vector<double>& milliseconds);

/// One row. A time is from having both images in memory to having the pose; files are left out.
struct SpeedResult {
  cv::Size size;
  int features = 0;  ///< aimed at
  int threads = 0;
  std::size_t pairs = 0;                     ///< counted
  double used = 0.0;                         ///< features that the motion was measured with, median
  Distribution rectified;                    ///< without rectification
  Distribution raw;                          ///< with it, of both images
  std::array<double, kStageCount> stages{};  ///< medians, ms
  ReferenceTimes reference;                  ///< medians, of the same images in the same minute

  double stage(Stage which) const { return stages[static_cast<std::size_t>(which)]; }
  /// As multiples of the reference's KLT, and of its KLT and both remaps.
  double rectifiedRatio() const { return rectified.median / reference.klt; }
  double rawRatio() const { return raw.median / (reference.klt + reference.remap); }
};

/// The exponent p of time ~ amount^p that fits the points best, in logarithms. Two points or more, all
/// positive.
double growthExponent(const std::vector<double>& amounts, const std::vector<double>& times);

/// Drives over the campus with raw images of each size, rendered on first use. Throws std::invalid_argument
/// if there is nothing to time.
std::vector<SpeedResult> runSpeedBenchmark(const SpeedSettings& settings, const WorkObserver& observer);

}  // namespace cartvo::benchmark
