#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/benchmark/accuracy_benchmark.hpp"
#include "tools/benchmark/depth_regression.hpp"
#include "tools/benchmark/feature_counts.hpp"
#include "tools/benchmark/rate_errors.hpp"
#include "tools/benchmark/stage_times.hpp"

namespace cartvo::benchmark {

struct ThesisSettings {
  std::filesystem::path
      data;                   ///< real sequences, see realSequences; empty: only what is rendered is measured
  OdometrySettings odometry;  ///< its number of features is the tables' first
  int many_features = 9600;   ///< the second
  int depth_pairs = 8;        ///< rendered for the depth regression, with each rig
  int threads = 2;            ///< that render
};

/// The depth regression with one rig.
struct DepthResult {
  std::string rig;
  DepthSamples samples;
};

/// Detection over one sequence.
struct FeatureCountResult {
  std::string sequence;
  FeatureCountSeries fixed;
  FeatureCountSeries adaptive;
};

/// Times over one sequence, whose images have `image_size`.
struct StageTimeResult {
  std::string sequence;
  cv::Size image_size;
  double rectification_ms = 0.0;  ///< of raw pairs of that size; the replay's own where it rectifies
  StageMedians few;               ///< with the settings' features
  StageMedians many;
};

struct RateResult {
  std::string sequence;
  RateErrors errors;
};

/// What the thesis' tables and figures show, measured here.
struct ThesisResults {
  int features = 0;
  int many_features = 0;
  std::vector<DepthResult> depth;          ///< Table 5-1
  std::vector<FeatureCountResult> counts;  ///< Figures 4-13, 4-14
  std::vector<StageTimeResult> times;      ///< Table 5-2; of the longest sequence
  std::vector<RateResult> rates;           ///< Tables 5-3, 5-4
};

/// Throws what sequences and settings are refused for.
ThesisResults runThesisBenchmark(const ThesisSettings& settings, const WorkObserver& observer);

}  // namespace cartvo::benchmark
