// Micro-benchmarks of the inner loops (Google Benchmark): time per patch, image or match. Run it as
// `cartvo_kernels --benchmark_repetitions=9 --benchmark_report_aggregates_only`.
#include <optional>
#include <vector>

#include <benchmark/benchmark.h>
#include <opencv2/imgproc.hpp>

#include "calib/rectification/rectification_tables.hpp"
#include "calib/rectification/rectifier.hpp"
#include "vo_core/image/affine_alignment.hpp"
#include "vo_core/image/image_pyramid.hpp"
#include "vo_core/image/shift_tracking.hpp"
#include "vo_core/stereo/stereo_matcher.hpp"
#include "vo_core/tracking/adaptive_detector.hpp"
#include "vo_core/tracking/alignment_block.hpp"
#include "vo_core/tracking/fast_corners.hpp"

namespace {

using ::benchmark::State;
using namespace cartvo;  // NOLINT(google-build-using-namespace): a program of its own

constexpr int kWidth = 1241, kHeight = 376;  // px, KITTI's
constexpr int kGreyLevels = 4;
constexpr double kDisparity = 12.3, kFlow = 3.7;  // px

/// An image of smooth noise, with texture everywhere and at several scales.
cv::Mat texture() {
  cv::RNG random(1);
  cv::Mat sum = cv::Mat::zeros(kHeight, kWidth, CV_32F);
  for (const int coarseness : {2, 5, 11}) {
    cv::Mat noise(kHeight / coarseness + 2, kWidth / coarseness + 2, CV_32F), grown;
    random.fill(noise, cv::RNG::UNIFORM, 0.0, 80.0);
    cv::resize(noise, grown, sum.size(), 0, 0, cv::INTER_CUBIC);
    sum += grown;
  }
  cv::Mat bytes;
  sum.convertTo(bytes, CV_8U);
  return bytes;
}

cv::Mat shifted(const cv::Mat& image, double columns) {
  const cv::Mat shift = (cv::Mat_<double>(2, 3) << 1, 0, columns, 0, 1, 0);
  cv::Mat moved;
  cv::warpAffine(image, moved, shift, image.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT_101);
  return moved;
}

const cv::Mat kImage = texture();

struct Pyramids {
  vo::ImagePyramid image = vo::buildPyramid(kImage, kGreyLevels);
  vo::ImagePyramid right = vo::buildPyramid(shifted(kImage, -kDisparity), kGreyLevels);
  vo::ImagePyramid next = vo::buildPyramid(shifted(kImage, kFlow), kGreyLevels);
};
const Pyramids& pyramids() {
  static const Pyramids built;
  return built;
}

/// A sequence of positions away from the image edges; consecutive patches are far apart in memory, as in a
/// real image.
class Positions {
 public:
  Eigen::Vector2d next() {
    index_ = (index_ + 1) % kCount;
    return {100.0 + (index_ * 37) % (kWidth - 200), 40.0 + (index_ * 13) % (kHeight - 80)};
  }

 private:
  static constexpr int kCount = 1000;
  int index_ = 0;
};

void pyramid(State& state) {
  vo::PyramidPool pool(kGreyLevels);
  for (auto _ : state)
    ::benchmark::DoNotOptimize(pool.build(kImage));
}
BENCHMARK(pyramid)->Unit(::benchmark::kMicrosecond);

void corners(State& state) {
  vo::WindowThresholds thresholds(kImage.size(), 1);
  thresholds.set({0, 0, kWidth, kHeight}, static_cast<std::uint8_t>(state.range()));
  vo::CornerFinder finder;
  for (auto _ : state)
    ::benchmark::DoNotOptimize(finder.find(kImage, {0, kHeight}, thresholds).data());
}
BENCHMARK(corners)->Arg(10)->Arg(40)->Unit(::benchmark::kMicrosecond);

void detect(State& state) {
  const cv::Size size = kImage.size();
  vo::AdaptiveDetector detector(vo::DetectionSettings{}, 1000, size);
  for (auto _ : state) {
    vo::SpacingGrid spacing(size.width, size.height, vo::TrackingSettings{}.minimum_distance);
    ::benchmark::DoNotOptimize(detector.detect({kImage}, {}, spacing));
  }
}
BENCHMARK(detect)->Unit(::benchmark::kMicrosecond);

// Landmarks are aligned in batches of this size; the reported time is that of one task.
constexpr int kTasksPerBatch = static_cast<int>(vo::AlignmentBlock::kCapacity);

void shiftTracking(State& state) {
  Positions positions;
  std::vector<vo::ShiftTask> tasks(kTasksPerBatch);
  std::vector<std::optional<Eigen::Vector2d>> shifted(tasks.size());
  while (state.KeepRunningBatch(kTasksPerBatch)) {
    for (vo::ShiftTask& task : tasks) {
      const Eigen::Vector2d from = positions.next();
      task = {&pyramids().image, &pyramids().next, from, from, {0, 1}};
    }
    vo::trackShifts(tasks, 0.5, shifted);
    ::benchmark::DoNotOptimize(shifted.data());
  }
}
BENCHMARK(shiftTracking)->Unit(::benchmark::kNanosecond);

void align(State& state) {
  const vo::TrackingSettings settings;
  Positions positions;
  std::vector<vo::AlignmentTask> tasks(kTasksPerBatch);
  std::vector<std::optional<vo::AffineAlignment>> aligned(tasks.size());
  while (state.KeepRunningBatch(kTasksPerBatch)) {
    for (vo::AlignmentTask& task : tasks) {
      task = {&pyramids().image.grey.front(), &pyramids().next.grey.front(), positions.next(), {}};
      task.start.position = task.from + Eigen::Vector2d(kFlow + 0.3, 0.0);
    }
    vo::alignAffine(tasks, settings.iterations, settings.convergence, aligned);
    ::benchmark::DoNotOptimize(aligned.data());
  }
}
BENCHMARK(align)->Unit(::benchmark::kNanosecond);

void searchStereo(State& state) {
  Positions positions;
  for (auto _ : state)
    ::benchmark::DoNotOptimize(
        vo::matchStereo(pyramids().image, pyramids().right, positions.next(), vo::StereoSettings{}));
}
BENCHMARK(searchStereo)->Unit(::benchmark::kNanosecond);

void rectify(State& state) {
  calib::Rig rig;
  rig.left.size = kImage.size();
  rig.left.fx = rig.left.fy = 720.0;
  rig.left.cx = 0.5 * (kWidth - 1);
  rig.left.cy = 0.5 * (kHeight - 1);
  rig.left.distortion = {-0.2, 0.05};
  rig.right = rig.left;
  rig.T_right_left.translation().x() = -0.5;
  const calib::RectificationSettings settings;
  const calib::Rectifier rectifier(rig, settings, calib::buildTables(rig, settings));
  cv::Mat rectified;
  for (auto _ : state) {
    rectifier.rectifyLeft(kImage, rectified);
    ::benchmark::DoNotOptimize(rectified.data);
  }
}
BENCHMARK(rectify)->Unit(::benchmark::kMicrosecond);

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  ::benchmark::Initialize(&argc, argv);
  if (::benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  ::benchmark::RunSpecifiedBenchmarks();
  ::benchmark::Shutdown();
  return 0;
}
