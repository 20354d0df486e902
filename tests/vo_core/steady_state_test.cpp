// A program of its own, as it counts what the whole program allocates.
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <ostream>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core/utility.hpp>

#include "vo_core/corridor_world.hpp"
#include "vo_core/image_pyramid.hpp"
#include "vo_core/stereo_odometry.hpp"

namespace {

std::atomic<long> allocations{0};

}  // namespace

// In place of the C library's, which operator new, Eigen and OpenCV's images all call. Those that allocate
// are replaced; what they give is freed by the library's own.
extern "C" {
// NOLINTBEGIN(readability-identifier-naming): as glibc names them
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
// NOLINTEND(readability-identifier-naming)

void* malloc(std::size_t size) noexcept {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) noexcept {
  ++allocations;
  return __libc_realloc(memory, size);
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
  ++allocations;
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  return memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) noexcept {
  *memory = memalign(alignment, size);
  return *memory != nullptr ? 0 : ENOMEM;
}
}

namespace cartvo {
namespace {

constexpr StereoCamera kCamera{230.0, 159.5, 119.5, 0.15, 320, 240};
constexpr int kSettled = 10;            // the window is full by then
constexpr int kBrake = 14, kStop = 24;  // from the one on the cart slows down, from the other on it stands
constexpr int kPairs = 40;
constexpr int kKeyFrames = 6;  // pairs from one to the next
constexpr std::int64_t kStep = 50'000'000;

/// A cart that drives, turns, slows down and stops.
const std::vector<StereoImages>& drive() {
  static const std::vector<StereoImages> pairs = [] {
    const test::CorridorWorld world(5);
    std::vector<StereoImages> rendered;
    double way = 0.0;  // in full steps
    for (int i = 0; i <= kStop; ++i) {
      Eigen::Isometry3d pose(Eigen::AngleAxisd(0.01 * way, Eigen::Vector3d::UnitY()));
      pose.translation().z() = 0.2 * way;
      rendered.push_back(world.render(kCamera, pose, i * kStep));
      way += std::min(1.0, static_cast<double>(kStop - i) / (kStop - kBrake));
    }
    rendered.resize(kPairs, rendered.back());
    for (int i = kStop; i < kPairs; ++i)
      rendered[i].left_exposure_ns = rendered[i].right_exposure_ns = i * kStep;
    for (int i = 0; i < kPairs; i += kKeyFrames)
      rendered[i].key_frames = {true, true};
    return rendered;
  }();
  return pairs;
}

TEST(Allocations, AreCountedWhoeverAsksForThem) {
  const long before = allocations;
  const cv::Mat image(100, 100, CV_8UC1);
  EXPECT_GT(allocations, before);
  const long with_image = allocations;
  const Eigen::MatrixXd matrix(10, 10);
  EXPECT_GT(allocations, with_image);
  const long with_matrix = allocations;
  const std::vector<PyramidLevel> levels(1, PyramidLevel(image.size()));
  EXPECT_GT(allocations, with_matrix);
}

struct Run {
  int threads, features;
};
void PrintTo(const Run& run, std::ostream* out) {
  *out << run.threads << " threads, " << run.features << " features";
}

class SteadyState : public testing::TestWithParam<Run> {
 protected:
  void SetUp() override { cv::setNumThreads(GetParam().threads); }
  void TearDown() override { cv::setNumThreads(-1); }
};

// Whether the cart drives, turns, brakes or stands. But for the library of parallel loops: each thread of its
// own gets memory once, whenever it first finds something to do.
TEST_P(SteadyState, AllocatesNothing) {
  OdometrySettings settings;
  settings.features = GetParam().features;
  StereoOdometry odometry(kCamera, settings);
  NullStageObserver observer;
  int allocating = 0;  // pairs
  for (int i = 0; i < kPairs; ++i) {
    const long before = allocations;
    const OdometryEstimate estimate = odometry.process(drive()[i], observer);
    if (i >= kSettled && allocations != before) ++allocating;
    EXPECT_EQ(estimate.valid, i > 0) << i;
    EXPECT_GT(estimate.counts.detected, settings.features / 2) << i;
    EXPECT_TRUE(i < kPairs - 1 || estimate.reasons == OdometryReason::zero_velocity);
  }
  EXPECT_LE(allocating, GetParam().threads - 1);
}

INSTANTIATE_TEST_SUITE_P(ThreadsAndFeatures, SteadyState,
                         testing::Values(Run{1, 150}, Run{1, 500}, Run{2, 150}, Run{2, 500}));

}  // namespace
}  // namespace cartvo
