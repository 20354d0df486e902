#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include <cartvo/odometry_t.hpp>

#include "pipeline/pair_processor.hpp"

// The numbers of one odometry message that the status page plots.

namespace cartvo::daemon {

/// Names of the numbers of a sample, in the order in which the page receives them. Lengths in m, angles in
/// rad, times in s unless the name says otherwise; `stddev_`: standard deviations; `bound_`: bounds as in
/// odometry_t, of the last second's motion the largest of the three axes. x, y, z, yaw: pose in the
/// world; xx, xy, yy: covariance of x and y in the world's axes.
inline constexpr std::array kSampleFields{"sequence",
                                          "utime_us",
                                          "valid",
                                          "reasons",
                                          "epoch",
                                          "x",
                                          "y",
                                          "z",
                                          "yaw",
                                          "xx",
                                          "xy",
                                          "yy",
                                          "speed",
                                          "stddev_speed",
                                          "roll_rate",
                                          "stddev_roll_rate",
                                          "pitch_rate",
                                          "stddev_pitch_rate",
                                          "yaw_rate",
                                          "stddev_yaw_rate",
                                          "latency_ms",
                                          "process_ms",
                                          "offset_ms",
                                          "features",
                                          "tracked",
                                          "inliers",
                                          "quality",
                                          "bound_speed",
                                          "bound_roll_rate",
                                          "bound_pitch_rate",
                                          "bound_yaw_rate",
                                          "bound_motion",
                                          "bound_rotation"};

/// Values in the order of kSampleFields; NaN: unknown.
struct PageSample {
  std::array<double, kSampleFields.size()> values{};

  std::int64_t sequence() const { return static_cast<std::int64_t>(values[0]); }
  std::int64_t utime() const { return static_cast<std::int64_t>(values[1]); }  ///< us since the Unix epoch
  bool isValid() const { return values[2] != 0.0; }
  std::int32_t reasons() const { return static_cast<std::int32_t>(values[3]); }
  std::int32_t epoch() const { return static_cast<std::int32_t>(values[4]); }
  double x() const { return values[5]; }
  double y() const { return values[6]; }
};

/// `process`: duration of the pair's processing, s; NaN for a pair that did not arrive.
PageSample pageSample(const odometry_t& message, double process);

/// The sample as a JSON array.
void appendJson(const PageSample& sample, std::string& json);

/// A number as JSON with `digits` significant digits; null if it is not finite.
void appendNumber(double value, int digits, std::string& json);

/// The last minute of samples and the path since the start, both bounded: the path has at most
/// kMaxPathPoints, at distances that double when it is full. Not thread-safe.
class PageHistory {
 public:
  static constexpr std::int64_t kSpan_us = 60'000'000;
  static constexpr std::size_t kMaxSamples = 2048;
  static constexpr std::size_t kMaxPathPoints = 2000;

  void add(const PageSample& sample);

  bool empty() const { return samples_.empty(); }
  const PageSample& newest() const { return samples_.back(); }
  std::size_t size() const { return samples_.size(); }
  std::size_t pathSize() const { return path_.size(); }

  /// The newest samples as a JSON array, at most `count`.
  std::string newestJson(std::size_t count) const;

  /// {"samples": [...], "path": [...]}: all samples, and those that are points of the path.
  std::string json() const;

 private:
  void addToPath(const PageSample& sample);

  std::deque<PageSample> samples_;
  std::vector<PageSample> path_;
  double spacing_ = 0.1;  ///< m, between points of the path
};

}  // namespace cartvo::daemon
