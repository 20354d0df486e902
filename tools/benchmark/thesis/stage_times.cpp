// Median time of each stage.
#include "tools/benchmark/thesis/stage_times.hpp"

#include <chrono>
#include <vector>

#include <opencv2/core.hpp>

#include "calib/rectification/rectification_tables.hpp"
#include "calib/rectification/rectifier.hpp"
#include "common/statistics.hpp"

namespace cartvo::benchmark {
namespace {

template <typename Value>
double medianMs(const Replay& replay, Value value) {
  std::vector<double> milliseconds;
  for (std::size_t i = 1; i < replay.pairs.size(); ++i)
    milliseconds.push_back(1e3 * value(replay.pairs[i].times));
  return percentile(milliseconds, 0.5);
}

/// A rig of two cameras of that size with the lens distortion of a surveillance camera.
calib::Rig distortedRig(cv::Size size) {
  calib::Rig rig;
  calib::CameraModel& camera = rig.left;
  camera.size = size;
  camera.fx = camera.fy = 0.6 * size.width;
  camera.cx = 0.5 * (size.width - 1);
  camera.cy = 0.5 * (size.height - 1);
  camera.distortion = {-0.2, 0.05};
  rig.right = rig.left;
  rig.T_right_left.translation().x() = -0.5;
  return rig;
}

}  // namespace

StageMedians stageMedians(const Replay& replay) {
  StageMedians medians;
  for (int i = 0; i < vo::kStageCount; ++i) {
    const auto stage = static_cast<vo::Stage>(i);
    medians.stages[i] =
        medianMs(replay, [stage](const pipeline::StageTimes& times) { return times.stage(stage); });
  }
  medians.total = medianMs(replay, [](const pipeline::StageTimes& times) { return times.total; });
  return medians;
}

double rectificationMs(cv::Size size) {
  const calib::Rig rig = distortedRig(size);
  const calib::RectificationSettings settings;
  const calib::Rectifier rectifier(rig, settings, calib::buildTables(rig, settings));
  cv::Mat raw(size, CV_8UC1), left, right;
  cv::randu(raw, 0, 256);
  std::vector<double> milliseconds;
  constexpr int kRuns = 21;
  for (int run = 0; run < kRuns; ++run) {
    const auto start = std::chrono::steady_clock::now();
    rectifier.rectifyLeft(raw, left);
    rectifier.rectifyRight(raw, right);
    milliseconds.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  return percentile(milliseconds, 0.5);
}

}  // namespace cartvo::benchmark
