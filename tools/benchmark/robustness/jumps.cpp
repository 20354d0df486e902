// Turns the cameras of recorded images by a homography behind the lens.
#include "tools/benchmark/robustness/jumps.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "calib/model/lens.hpp"
#include "common/units.hpp"
#include "tools/evaluate/evaluation.hpp"

namespace cartvo::benchmark {
namespace {

constexpr double kJump = 5.0 * kRadiansPerDegree;     // rad
constexpr std::int64_t kTimeBetween = 1'000'000'000;  // ns between two jumps

/// Which of the two directions the cameras look to: 0 or 1.
std::size_t directionAt(std::int64_t exposure_ns, std::int64_t first_ns) {
  return static_cast<std::size_t>(std::max<std::int64_t>(exposure_ns - first_ns, 0) / kTimeBetween % 2);
}

/// Border that a camera turned by `angle` does not see, px: the largest motion of a pixel of a pinhole
/// camera.
int unseenBorder(const calib::CameraModel& camera, double angle) {
  const double x = std::max(camera.cx, camera.size.width - camera.cx) / camera.fx;
  const double y = std::max(camera.cy, camera.size.height - camera.cy) / camera.fy;
  return static_cast<int>(
      std::ceil(std::max(camera.fx, camera.fy) * std::tan(angle) * (1.0 + std::max(x * x, y * y))));
}

/// The camera without `border` px at each side of its images, and without its mask: what a turned camera
/// shows at a pixel is not what the true one did.
calib::CameraModel cropped(calib::CameraModel camera, int border) {
  camera.size -= cv::Size(2 * border, 2 * border);
  camera.cx -= border;
  camera.cy -= border;
  camera.mask = {};
  return camera;
}

/// For each pixel of `to`, the position in an image of `from` of its ray turned by `rotation`. CV_32FC2.
cv::Mat turnedPositions(const calib::CameraModel& from, const calib::CameraModel& to,
                        const Eigen::Matrix3d& rotation) {
  const calib::Lens lens(from);
  cv::Mat positions(to.size, CV_32FC2);
  for (int y = 0; y < to.size.height; ++y) {
    for (int x = 0; x < to.size.width; ++x) {
      const Eigen::Vector3d ray = lens.undistort({(x - to.cx) / to.fx, (y - to.cy) / to.fy});
      const calib::NormalisedPoint seen = lens.distort(rotation * ray);
      positions.at<cv::Vec2f>(y, x) = {static_cast<float>(from.fx * seen.x + from.cx),
                                       static_cast<float>(from.fy * seen.y + from.cy)};
    }
  }
  return positions;
}

}  // namespace

Jumps jumpsOf(const calib::Rig& rig, const Trajectory& truth, std::int64_t first_ns,
              const Eigen::Vector3d& axis) {
  const std::array<Eigen::Matrix3d, 2> left{Eigen::AngleAxisd(-0.5 * kJump, axis).toRotationMatrix(),
                                            Eigen::AngleAxisd(0.5 * kJump, axis).toRotationMatrix()};
  const Eigen::Matrix3d R_right_left = rig.T_right_left.linear();
  const int border = std::max(unseenBorder(rig.left, 0.5 * kJump), unseenBorder(rig.right, 0.5 * kJump));
  Jumps jumps{{}, rig, truth};
  jumps.rig.left = cropped(rig.left, border);
  jumps.rig.right = cropped(rig.right, border);
  std::array<std::array<cv::Mat, 2>, 2> maps;  // of each direction, for the left and the right camera
  for (std::size_t i = 0; i < 2; ++i)
    maps[i] = {
        turnedPositions(rig.left, jumps.rig.left, left[i]),
        turnedPositions(rig.right, jumps.rig.right, R_right_left * left[i] * R_right_left.transpose())};
  jumps.turned = [maps, first_ns](const cv::Mat& image, bool is_left, std::int64_t exposure_ns) {
    cv::Mat turned;
    cv::remap(image, turned, maps[directionAt(exposure_ns, first_ns)][is_left ? 0 : 1], {}, cv::INTER_CUBIC,
              cv::BORDER_REPLICATE);
    return turned;
  };
  for (StampedPose& pose : jumps.truth)
    pose.pose.rotate(left[directionAt(pose.time_ns, first_ns)]);
  if (!truth.empty()) jumps.truth = startingAt(Eigen::Isometry3d::Identity(), jumps.truth);
  return jumps;
}

}  // namespace cartvo::benchmark
