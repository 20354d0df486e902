// The measurement behind the renderer's proof: images against the truth they were rendered from.
#include "tests/tools/world/warp.hpp"

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "tools/world/lens.hpp"

namespace cartvo::test {
namespace {

constexpr double kInvalid = std::numeric_limits<double>::quiet_NaN();

const CameraModel& modelOf(const Rig& rig, CameraSide side) {
  return side == CameraSide::left ? rig.left : rig.right;
}

Eigen::Isometry3d T_world_camera(const world::RenderedWorld& world, const Exposure& at) {
  const Rig rig = world.rig();
  const bool left = at.side == CameraSide::left;
  const std::int64_t instant = left ? world.leftInstant(at.index) : world.rightInstant(at.index);
  const Eigen::Isometry3d T_body_camera =
      left ? rig.T_body_camera : rig.T_body_camera * rig.T_right_left.inverse();
  return world.T_world_body(1e-9 * static_cast<double>(instant)) * T_body_camera;
}

constexpr int kReach = 4;  // of the interpolation, px

/// The sinc function below a wider one (Lanczos): bends less than cubic interpolation where texture is fine.
double lanczosWeight(double x) {
  if (std::abs(x) < 1e-9) return 1.0;
  if (std::abs(x) >= kReach) return 0.0;
  const double angle = std::numbers::pi * x;
  return kReach * std::sin(angle) * std::sin(angle / kReach) / (angle * angle);
}

double interpolate(const cv::Mat& image, const Eigen::Vector2d& at) {
  const int x0 = static_cast<int>(std::floor(at.x())) - kReach + 1;
  const int y0 = static_cast<int>(std::floor(at.y())) - kReach + 1;
  std::array<double, 2 * kReach> across{};
  for (int i = 0; i < 2 * kReach; ++i)
    across[i] = lanczosWeight(at.x() - (x0 + i));
  double sum = 0.0;
  double weights = 0.0;
  for (int j = 0; j < 2 * kReach; ++j) {
    const double down = lanczosWeight(at.y() - (y0 + j));
    const auto* row = image.ptr<float>(y0 + j);
    for (int i = 0; i < 2 * kReach; ++i) {
      sum += across[i] * down * row[x0 + i];
      weights += across[i] * down;
    }
  }
  return sum / weights;
}

/// Grey levels in floating point, without the sensor's rounding; smoothed a little, because what is finer
/// than two pixels cannot be interpolated.
cv::Mat greyLevels(const world::RenderedWorld& world, const Exposure& at) {
  constexpr double kSmoothing = 0.7;  // px
  constexpr double kMean = 0.2;       // of full scale, linear
  cv::Mat image = world.radiance(at.index, at.side);
  cv::pow(image * (kMean / cv::mean(image)[0]), 1.0 / 2.2, image);
  cv::GaussianBlur(255.0 * image, image, cv::Size(), kSmoothing);
  return image;
}

/// Planes have an inverse depth that is linear in the image: a bend in it is an edge.
bool smoothAround(const world::DepthImage& seen, int x, int y) {
  constexpr int kAround = 2;
  for (int v = y - kAround; v <= y + kAround; ++v) {
    for (int u = x - kAround; u <= x + kAround; ++u) {
      if (seen.moving.at<std::uint8_t>(v, u) != 0 || seen.depth.at<float>(v, u) <= 0.0F) return false;
    }
  }
  const auto inverse = [&](int u, int v) { return 1.0 / seen.depth.at<float>(v, u); };
  const double own = inverse(x, y);
  const double bend_x = inverse(x - kAround, y) - 2.0 * own + inverse(x + kAround, y);
  const double bend_y = inverse(x, y - kAround) - 2.0 * own + inverse(x, y + kAround);
  return std::abs(bend_x) < 2e-3 * own && std::abs(bend_y) < 2e-3 * own;
}

/// Where truth puts each pixel of `from` in `to`: CV_64FC2, NaN where there is nothing to compare.
cv::Mat correspondences(const world::RenderedWorld& world, const Exposure& from, const Exposure& to) {
  constexpr int kMargin = kReach + 2;
  const Rig rig = world.rig();
  const world::DepthImage seen = world.renderDepth(from.index, from.side);
  const world::DepthImage other = world.renderDepth(to.index, to.side);
  const Eigen::Isometry3d T_to_from = T_world_camera(world, to).inverse() * T_world_camera(world, from);
  cv::Mat places(seen.depth.size(), CV_64FC2, cv::Scalar(kInvalid, kInvalid));
  for (int y = 3; y < places.rows - 3; ++y) {
    for (int x = 3; x < places.cols - 3; ++x) {
      if (seen.depth.at<float>(y, x) > 60.0F || !smoothAround(seen, x, y)) continue;
      const Eigen::Vector2d ray = world::undistort(modelOf(rig, from.side), Eigen::Vector2d(x, y));
      const Eigen::Vector3d point = T_to_from * (seen.depth.at<float>(y, x) * ray.homogeneous());
      if (point.z() < 0.5) continue;
      const Eigen::Vector2d p = world::distort(modelOf(rig, to.side), point.hnormalized());
      if (p.x() < kMargin || p.y() < kMargin || p.x() > places.cols - 1 - kMargin ||
          p.y() > places.rows - 1 - kMargin)
        continue;
      const int u = static_cast<int>(std::lround(p.x()));
      const int v = static_cast<int>(std::lround(p.y()));
      if (!smoothAround(other, u, v) || std::abs(other.depth.at<float>(v, u) - point.z()) > 0.05 * point.z())
        continue;
      places.at<cv::Vec2d>(y, x) = cv::Vec2d(p.x(), p.y());
    }
  }
  return places;
}

constexpr int kHalf = 7;  // of a patch, px

/// One step of Lucas and Kanade's method with gain and offset, gain W + offset - I = grad I . d, where W is
/// `to` at the places less `shift`. Nothing where a pixel of the patch has no place or the texture is too
/// weak.
std::optional<Eigen::Vector2d> step(const cv::Mat& image, const cv::Mat& to, const cv::Mat& places,
                                    const cv::Point& centre, const Eigen::Vector2d& shift) {
  constexpr double kLeastTexture = 2.0;  // smaller eigenvalue of the mean structure tensor, grey levels^2
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (int y = centre.y - kHalf; y <= centre.y + kHalf; ++y) {
    for (int x = centre.x - kHalf; x <= centre.x + kHalf; ++x) {
      const cv::Vec2d& place = places.at<cv::Vec2d>(y, x);
      if (std::isnan(place[0])) return std::nullopt;
      const double w = interpolate(to, Eigen::Vector2d(place[0], place[1]) - shift);
      const double gx = 0.5 * (image.at<float>(y, x + 1) - image.at<float>(y, x - 1));
      const double gy = 0.5 * (image.at<float>(y + 1, x) - image.at<float>(y - 1, x));
      const Eigen::Vector4d row(gx, gy, -w, -1.0);
      normal += row * row.transpose();
      right -= row * image.at<float>(y, x);
    }
  }
  const double pixels = (2 * kHalf + 1) * (2 * kHalf + 1);
  const Eigen::Matrix2d tensor = normal.topLeftCorner<2, 2>() / pixels;
  if (Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(tensor).eigenvalues()[0] < kLeastTexture)
    return std::nullopt;
  return normal.ldlt().solve(right).head<2>();
}

}  // namespace

std::vector<WarpResidual> warpResiduals(const world::RenderedWorld& world, const Exposure& from,
                                        const Exposure& to) {
  const cv::Mat image = greyLevels(world, from);
  const cv::Mat other = greyLevels(world, to);
  const cv::Mat places = correspondences(world, from, to);
  std::vector<WarpResidual> residuals;
  for (int y = kHalf + 4; y < image.rows - kHalf - 4; y += kHalf) {
    for (int x = kHalf + 4; x < image.cols - kHalf - 4; x += kHalf) {
      const std::optional<Eigen::Vector2d> first = step(image, other, places, {x, y}, {0.0, 0.0});
      if (!first) continue;
      const std::optional<Eigen::Vector2d> second = step(image, other, places, {x, y}, *first);
      const cv::Vec2d& place = places.at<cv::Vec2d>(y, x);
      residuals.push_back({{place[0] - x, place[1] - y}, second ? *first + *second : *first});
    }
  }
  return residuals;
}

}  // namespace cartvo::test
