#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "tools/benchmark/accuracy_benchmark.hpp"
#include "tools/benchmark/reference_work.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/stage_observer.hpp"

namespace cartvo::benchmark {

/// What is timed: each drive with each number of features on each number of threads.
struct SpeedSettings {
  std::vector<cv::Size> sizes;  ///< in which a drive over the campus is rendered
  std::filesystem::path data;   ///< real sequences, see realSequences; empty: none
  std::vector<int> features;
  std::vector<int> threads;
  OdometrySettings odometry;  ///< but for the features
  int pairs = 24;             ///< of each drive at most, at least kWarmUp + 2
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
  std::string drive;
  cv::Size size;
  int features = 0;  ///< aimed at
  int threads = 0;
  std::size_t pairs = 0;                     ///< counted
  double used = 0.0;                         ///< features that the motion was measured with, median
  Distribution rectified;                    ///< without rectification
  Distribution raw;                          ///< with it, of both images
  std::array<double, kStageCount> stages{};  ///< medians, ms
  ReferenceTimes reference;                  ///< medians, of images of the same drive
  /// Medians of the pairs' times as multiples of what the reference took just before and after.
  double rectified_ratio = 0.0;  ///< to its KLT
  double raw_ratio = 0.0;        ///< to its KLT and both remaps

  double stage(Stage which) const { return stages[static_cast<std::size_t>(which)]; }
};

/// The exponent p of time ~ amount^p that fits the points best, in logarithms. Two points or more, all
/// positive.
double growthExponent(const std::vector<double>& amounts, const std::vector<double>& times);

/// Drives over the campus with raw images of each size, rendered on first use, then the real sequences; one
/// whose images are rectified already follows once more behind lenses (throughLenses). Throws
/// std::invalid_argument if there is nothing to time, std::runtime_error naming a sequence that cannot be.
std::vector<SpeedResult> runSpeedBenchmark(const SpeedSettings& settings, const WorkObserver& observer);

}  // namespace cartvo::benchmark
