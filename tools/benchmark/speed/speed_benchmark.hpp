#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "tools/benchmark/accuracy/accuracy_benchmark.hpp"
#include "tools/benchmark/speed/reference_work.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/stage_observer.hpp"

namespace cartvo::benchmark {

/// Settings of a speed benchmark: each drive is timed with each number of features and of threads.
struct SpeedSettings {
  std::vector<cv::Size> sizes;  ///< image sizes of the rendered campus drive
  std::filesystem::path data;   ///< real sequences, see realSequences; empty: none
  std::vector<int> features;
  std::vector<int> threads;
  vo::OdometrySettings odometry;  ///< except `features`
  int pairs = 24;                 ///< maximum per drive; at least kWarmUpPairs + 2
  int repeats = 3;                ///< of each drive, each with a new odometry
  int rendering_threads = 2;
  std::filesystem::path cache;  ///< for rendered worlds
};

/// Number of pairs at the start of each repeat that are not counted, while the odometry fills its window and
/// allocates memory.
inline constexpr int kWarmUpPairs = 4;

/// Statistics of times, ms.
struct Distribution {
  double median = 0.0;
  double p99 = 0.0;
  double maximum = 0.0;
};

/// `milliseconds` must not be empty.
Distribution distributionOf(const std::vector<double>& milliseconds);

/// The times of one drive with one number of features and threads: from both images in memory to the pose,
/// without reading files.
struct SpeedResult {
  std::string drive;
  cv::Size size;
  int features = 0;  ///< target number
  int threads = 0;
  std::size_t pairs = 0;                         ///< counted
  double used = 0.0;                             ///< median number of features used for the motion
  Distribution rectified;                        ///< time without rectification
  Distribution raw;                              ///< time with rectification of both images
  std::array<double, vo::kStageCount> stages{};  ///< medians, ms
  ReferenceTimes reference;                      ///< medians, on images of the same drive
  /// Median times of a pair as multiples of the reference times measured just before and after.
  double rectified_ratio = 0.0;  ///< to its KLT
  double raw_ratio = 0.0;        ///< to its KLT and both remaps

  double stage(vo::Stage which) const { return stages[static_cast<std::size_t>(which)]; }
};

/// The exponent p of time ~ amount^p, by least squares in logarithms. Requires two or more points, all
/// positive.
double growthExponent(const std::vector<double>& amounts, const std::vector<double>& times);

/// Times campus drives with raw images of each size, rendered on first use, then the real sequences. A
/// sequence with rectified images is timed a second time with lens distortion (throughLenses). Throws
/// std::invalid_argument if there is nothing to time, std::runtime_error naming a sequence that cannot be
/// timed.
std::vector<SpeedResult> runSpeedBenchmark(const SpeedSettings& settings, const WorkObserver& observer);

}  // namespace cartvo::benchmark
