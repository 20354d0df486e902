// A program of its own, as it counts what the whole program allocates.
#include <atomic>
#include <cstdlib>
#include <new>
#include <vector>

#include <gtest/gtest.h>

#include "vo_core/corridor_world.hpp"
#include "vo_core/stereo_odometry.hpp"

namespace {

std::atomic<long> allocations{0};

void* counted(void* memory) {
  ++allocations;
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void* operator new(std::size_t size) {
  return counted(std::malloc(size));
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  const auto step = static_cast<std::size_t>(alignment);
  return counted(std::aligned_alloc(step, (size + step - 1) / step * step));
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}

namespace cartvo {
namespace {

constexpr StereoCamera kCamera{230.0, 159.5, 119.5, 0.15, 320, 240};
constexpr int kPairs = 16, kSettled = 10;  // the window is full by then
constexpr std::int64_t kStep = 50'000'000;

/// By operator new, which vectors use; images have memory of OpenCV's.
double allocationsPerPair(int features) {
  const test::CorridorWorld world(5);
  std::vector<StereoImages> pairs;
  for (int i = 0; i < kPairs; ++i) {
    Eigen::Isometry3d pose(Eigen::AngleAxisd(0.01 * i, Eigen::Vector3d::UnitY()));
    pose.translation().z() = 0.2 * i;
    pairs.push_back(world.render(kCamera, pose, i * kStep));
  }
  OdometrySettings settings;
  settings.features = features;
  StereoOdometry odometry(kCamera, settings);
  NullStageObserver observer;
  long before = 0;
  for (int i = 0; i < kPairs; ++i) {
    if (i == kSettled) before = allocations;
    const OdometryEstimate estimate = odometry.process(pairs[i], observer);
    EXPECT_EQ(estimate.valid, i > 0);
    EXPECT_GT(estimate.counts.detected, features / 2);
  }
  return static_cast<double>(allocations - before) / (kPairs - kSettled);
}

// Lists of a whole pair are allocated, as many for few landmarks as for many; landmarks never.
TEST(SteadyState, AllocatesNothingPerLandmark) {
  const double few = allocationsPerPair(150), many = allocationsPerPair(500);
  EXPECT_LT(many, 80.0);
  EXPECT_NEAR(many, few, 20.0);
}

}  // namespace
}  // namespace cartvo
