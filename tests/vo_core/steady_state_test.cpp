// Test that the odometry keeps no memory in steady state, and allocates none for landmarks. A program of its
// own, because it counts the allocations of the whole program.
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <ostream>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core/utility.hpp>

#include "support/vo_core/corridor_world.hpp"
#include "vo_core/image/image_pyramid.hpp"
#include "vo_core/stereo_odometry.hpp"

namespace {

std::atomic<long> allocations{0}, released{0};

}  // namespace

// Replacements of the C library's allocation functions, which operator new, Eigen and OpenCV's images all
// call.
extern "C" {
// NOLINTBEGIN(readability-identifier-naming): as glibc names them
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* memory);
// NOLINTEND(readability-identifier-naming)

void* malloc(std::size_t size) noexcept {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  ++allocations;
  return __libc_calloc(count, size);
}
void free(void* memory) noexcept {
  if (memory != nullptr) ++released;
  __libc_free(memory);
}
void* realloc(void* memory, std::size_t size) noexcept {
  ++allocations;
  if (memory != nullptr) ++released;
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

namespace cartvo::vo {
namespace {

constexpr StereoCamera kCamera{230.0, 159.5, 119.5, 0.15, 320, 240};
constexpr int kWarmUpPairs = 10;        // pairs until the window is full
constexpr int kBrake = 14, kStop = 24;  // the cart slows down from the first on and stands from the second on
constexpr int kPairs = 40;
constexpr int kKeyFrames = 6;  // pairs between key frames
constexpr std::int64_t kStep = 50'000'000;

/// Images of a cart that drives, turns, slows down and stops.
const std::vector<StereoImages>& drive() {
  static const std::vector<StereoImages> pairs = [] {
    const test::CorridorWorld world(5);
    std::vector<StereoImages> images;
    double distance = 0.0;  // distance in full steps
    for (int i = 0; i <= kStop; ++i) {
      Eigen::Isometry3d pose(Eigen::AngleAxisd(0.01 * distance, Eigen::Vector3d::UnitY()));
      pose.translation().z() = 0.2 * distance;
      images.push_back(world.render(kCamera, pose, i * kStep));
      distance += std::min(1.0, static_cast<double>(kStop - i) / (kStop - kBrake));
    }
    images.resize(kPairs, images.back());
    for (int i = kStop; i < kPairs; ++i)
      images[i].left_exposure_ns = images[i].right_exposure_ns = i * kStep;
    for (int i = 0; i < kPairs; i += kKeyFrames)
      images[i].key_frames = {true, true};
    return images;
  }();
  return pairs;
}

TEST(Allocations, AreCountedForOpenCvEigenAndVectors) {
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

// In all phases: driving, turning, braking, standstill. A pair allocates matrices of the window, whose number
// does not depend on the landmarks, and frees them; nothing at a standstill. The library of parallel loops is
// exempt: each of its threads allocates once, when it first finds something to do.
TEST_P(SteadyState, KeepsNoMemory) {
  constexpr int kMatrices = 150;
  OdometrySettings settings;
  settings.features = GetParam().features;
  StereoOdometry odometry(kCamera, settings);
  NullStageObserver observer;
  int growing = 0;  // pairs
  for (int i = 0; i < kPairs; ++i) {
    const long before = allocations, before_kept = allocations - released;
    const OdometryEstimate estimate = odometry.process(drive()[i], observer);
    if (i >= kWarmUpPairs) {
      if (allocations - released > before_kept) ++growing;
      const bool stands = estimate.reasons == OdometryReason::zero_velocity;
      EXPECT_LE(allocations - before, (stands ? 0 : kMatrices) + GetParam().threads - 1) << i;
    }
    EXPECT_EQ(estimate.valid, i > 0) << i;
    EXPECT_GT(estimate.counts.detected, settings.features / 2) << i;
    EXPECT_TRUE(i < kPairs - 1 || estimate.reasons == OdometryReason::zero_velocity);
  }
  EXPECT_LE(growing, GetParam().threads - 1);
}

INSTANTIATE_TEST_SUITE_P(ThreadsAndFeatures, SteadyState,
                         testing::Values(Run{1, 150}, Run{1, 500}, Run{2, 150}, Run{2, 500}));

}  // namespace
}  // namespace cartvo::vo
