#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/benchmark/accuracy/accuracy_benchmark.hpp"
#include "tools/benchmark/thesis/depth_regression.hpp"
#include "tools/benchmark/thesis/feature_counts.hpp"
#include "tools/benchmark/thesis/rate_errors.hpp"
#include "tools/benchmark/thesis/stage_times.hpp"

namespace cartvo::benchmark {

/// Settings of the thesis benchmark.
struct ThesisSettings {
  std::filesystem::path
      data;  ///< real sequences, see realSequences; empty: only rendered worlds are measured
  vo::OdometrySettings odometry;  ///< its number of features is the first one of the tables
  int many_features = 9600;       ///< the second number of features
  int depth_pairs = 8;            ///< rendered pairs per rig for the depth regression
  int threads = 2;                ///< for rendering
};

/// The depth samples of one rig.
struct DepthResult {
  std::string rig;
  DepthSamples samples;
};

/// Feature counts of one sequence.
struct FeatureCountResult {
  std::string sequence;
  FeatureCountSeries fixed;
  FeatureCountSeries adaptive;
};

/// Stage times of one sequence.
struct StageTimeResult {
  std::string sequence;
  cv::Size image_size;
  double rectification_ms = 0.0;  ///< of raw pairs of `image_size`; from the replay if it rectifies
  StageMedians few;               ///< with ThesisResults::features
  StageMedians many;              ///< with ThesisResults::many_features
};

/// Velocity and rate errors of one sequence.
struct RateResult {
  std::string sequence;
  vo::Estimator estimator = vo::Estimator::thesis;
  RateErrors errors;
};

/// The measured values for the tables and figures of the thesis.
struct ThesisResults {
  int features = 0;
  int many_features = 0;
  std::vector<DepthResult> depth;          ///< Table 5-1
  std::vector<FeatureCountResult> counts;  ///< Figures 4-13, 4-14
  std::vector<StageTimeResult> times;      ///< Table 5-2; of the longest sequence
  std::vector<RateResult> rates;           ///< Tables 5-3 to 5-7; both estimators
};

/// Repeats the experiments of the thesis. Throws std::runtime_error naming a sequence that cannot be used,
/// std::invalid_argument for invalid settings.
ThesisResults runThesisBenchmark(const ThesisSettings& settings, const WorkObserver& observer);

}  // namespace cartvo::benchmark
