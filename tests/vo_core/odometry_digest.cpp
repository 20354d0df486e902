// Prints the estimates of a short drive to the last bit:
//   odometry_digest draw FILE     draws the drive's images
//   odometry_digest drive FILE    prints each estimate of both methods
// Drawing is a step of its own, because it uses sines: the images are then the same on each processor.
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/vo_core/corridor_world.hpp"
#include "vo_core/stereo_odometry.hpp"

namespace cartvo::vo {
namespace {

constexpr int kPairs = 5;
constexpr StereoCamera kCamera{230.0, 159.5, 119.5, 0.15, 320, 240};
constexpr std::int64_t kStep = 50'000'000, kTimeOffset = 10'000'000;  // ns

Eigen::Isometry3d poseAt(double step) {
  Eigen::Isometry3d pose(Eigen::AngleAxisd(0.01 * step, Eigen::Vector3d::UnitY()));
  pose.translation() = Eigen::Vector3d(0.02 * step, 0.0, 0.2 * step);
  return pose;
}

void draw(const std::string& file) {
  const test::CorridorWorld world(5);
  std::ofstream out(file, std::ios::binary);
  const auto write = [&](const cv::Mat& image) {
    out.write(reinterpret_cast<const char*>(image.data), static_cast<std::streamsize>(image.total()));
  };
  for (int i = 0; i < kPairs; ++i) {
    write(world.view(kCamera, poseAt(i)));
    write(world.rightView(kCamera, poseAt(i + static_cast<double>(kTimeOffset) / kStep)));
  }
  if (!out.flush()) throw std::runtime_error("cannot write " + file);
}

template <typename Matrix>
void print(const Matrix& matrix) {
  for (Eigen::Index i = 0; i < matrix.size(); ++i)
    std::printf(" %a", matrix(i % matrix.rows(), i / matrix.rows()));
}

void drive(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::vector<char> bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const std::size_t size = static_cast<std::size_t>(kCamera.width) * kCamera.height;
  if (bytes.size() != 2 * kPairs * size)
    throw std::runtime_error(file + ": wrong size, expected a file written by 'odometry_digest draw'");
  const auto image = [&](int index) {
    return cv::Mat(kCamera.height, kCamera.width, CV_8UC1, bytes.data() + index * size);
  };
  for (const Estimator estimator : {Estimator::reprojection, Estimator::thesis}) {
    OdometrySettings settings;
    settings.estimator = estimator;
    settings.features = 300;
    StereoOdometry odometry(kCamera, settings);
    NullStageObserver observer;
    for (int i = 0; i < kPairs; ++i) {
      const StereoImages pair{image(2 * i), image(2 * i + 1), i * kStep, i * kStep + kTimeOffset};
      const OdometryEstimate estimate = odometry.process(pair, observer);
      std::printf("%d %d", estimate.valid ? 1 : 0, estimate.counts.inliers);
      print(estimate.T_world_camera.matrix());
      print(estimate.motion_covariance);
      std::printf("\n");
    }
  }
}

}  // namespace
}  // namespace cartvo::vo

int main(int argc, char** argv) {
  try {
    if (argc != 3) throw std::runtime_error("usage: odometry_digest draw|drive FILE");
    if (std::strcmp(argv[1], "draw") == 0)
      cartvo::vo::draw(argv[2]);
    else
      cartvo::vo::drive(argv[2]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "odometry_digest: %s\n", error.what());
    return 1;
  }
  return 0;
}
