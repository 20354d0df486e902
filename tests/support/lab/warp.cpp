// Measures the geometric error of rendered images: displacement of patches from their true position.
#include "tests/support/lab/warp.hpp"

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "lab/render/tracing/lens.hpp"

namespace cartvo::test {
namespace {

constexpr double kNoPlace = std::numeric_limits<double>::quiet_NaN();

const calib::CameraModel& modelOf(const calib::Rig& rig, capture::CameraSide side) {
  return side == capture::CameraSide::left ? rig.left : rig.right;
}

/// Pose of a camera at the instant of a row.
Eigen::Isometry3d T_world_camera(const world::RenderedWorld& world, const Exposure& at, double row) {
  const calib::Rig rig = world.rig();
  const Eigen::Isometry3d T_body_camera = at.side == capture::CameraSide::left
                                              ? rig.T_body_camera
                                              : rig.T_body_camera * rig.T_right_left.inverse();
  return world.T_world_body(world.rowInstant(at.index, at.side, row)) * T_body_camera;
}

/// A point as a camera sees it.
struct SeenPoint {
  Eigen::Vector2d pixel;
  double depth = 0.0;  ///< m along the camera's z axis
};

/// The pixel in whose row's instant the camera sees a static point there. None if the point comes too near.
std::optional<SeenPoint> project(const world::RenderedWorld& world, const Exposure& at,
                                 const Eigen::Vector3d& in_world) {
  constexpr int kSteps = 4;  // the row moves by less than a tenth of a row's shift at each of them
  const calib::Rig rig = world.rig();
  SeenPoint seen{Eigen::Vector2d(0.0, 0.5 * (rig.left.size.height - 1))};
  for (int step = 0; step < kSteps; ++step) {
    const Eigen::Vector3d point = T_world_camera(world, at, seen.pixel.y()).inverse() * in_world;
    if (point.z() < 0.5) return std::nullopt;
    seen = {world::distort(modelOf(rig, at.side), point.hnormalized()), point.z()};
  }
  return seen;
}

constexpr int kKernelRadius = 4;  // px, of the interpolation kernel

/// Lanczos kernel, a windowed sinc: a smaller error than cubic interpolation on fine texture.
double lanczosWeight(double x) {
  if (std::abs(x) < 1e-9) return 1.0;
  if (std::abs(x) >= kKernelRadius) return 0.0;
  const double angle = std::numbers::pi * x;
  return kKernelRadius * std::sin(angle) * std::sin(angle / kKernelRadius) / (angle * angle);
}

double interpolate(const cv::Mat& image, const Eigen::Vector2d& at) {
  const int x0 = static_cast<int>(std::floor(at.x())) - kKernelRadius + 1;
  const int y0 = static_cast<int>(std::floor(at.y())) - kKernelRadius + 1;
  std::array<double, 2 * kKernelRadius> across{};
  for (int i = 0; i < 2 * kKernelRadius; ++i)
    across[i] = lanczosWeight(at.x() - (x0 + i));
  double sum = 0.0;
  double weights = 0.0;
  for (int j = 0; j < 2 * kKernelRadius; ++j) {
    const double down = lanczosWeight(at.y() - (y0 + j));
    const auto* row = image.ptr<float>(y0 + j);
    for (int i = 0; i < 2 * kKernelRadius; ++i) {
      sum += across[i] * down * row[x0 + i];
      weights += across[i] * down;
    }
  }
  return sum / weights;
}

/// Grey levels in floating point, without the sensor's rounding; smoothed, because details below two pixels
/// cannot be interpolated.
cv::Mat greyLevels(const world::RenderedWorld& world, const Exposure& at) {
  constexpr double kSmoothing = 0.7;  // px
  constexpr double kMean = 0.2;       // fraction of full scale, linear
  cv::Mat image = world.radiance(at.index, at.side);
  cv::pow(image * (kMean / cv::mean(image)[0]), 1.0 / 2.2, image);
  cv::GaussianBlur(255.0 * image, image, cv::Size(), kSmoothing);
  return image;
}

/// Whether the neighbourhood of (x, y) is static and has no depth edge. The inverse depth of a plane is
/// linear in the image, so curvature of the inverse depth is an edge.
bool isSmooth(const world::DepthImage& seen, int x, int y) {
  constexpr int kNeighbourRadius = 2;
  for (int v = y - kNeighbourRadius; v <= y + kNeighbourRadius; ++v) {
    for (int u = x - kNeighbourRadius; u <= x + kNeighbourRadius; ++u) {
      if (seen.moving.at<std::uint8_t>(v, u) != 0 || seen.depth.at<float>(v, u) <= 0.0F) return false;
    }
  }
  const auto inverse = [&](int u, int v) { return 1.0 / seen.depth.at<float>(v, u); };
  const double own = inverse(x, y);
  const double curvature_x = inverse(x - kNeighbourRadius, y) - 2.0 * own + inverse(x + kNeighbourRadius, y);
  const double curvature_y = inverse(x, y - kNeighbourRadius) - 2.0 * own + inverse(x, y + kNeighbourRadius);
  return std::abs(curvature_x) < 2e-3 * own && std::abs(curvature_y) < 2e-3 * own;
}

/// True position in `to` of each pixel of `from`: CV_64FC2, NaN where the images cannot be compared.
cv::Mat correspondences(const world::RenderedWorld& world, const Exposure& from, const Exposure& to) {
  constexpr int kMargin = kKernelRadius + 2;
  const calib::Rig rig = world.rig();
  const world::DepthImage seen = world.renderDepth(from.index, from.side);
  const world::DepthImage other = world.renderDepth(to.index, to.side);
  cv::Mat places(seen.depth.size(), CV_64FC2, cv::Scalar(kNoPlace, kNoPlace));
  for (int y = 3; y < places.rows - 3; ++y) {
    const Eigen::Isometry3d T_world_from = T_world_camera(world, from, y);
    for (int x = 3; x < places.cols - 3; ++x) {
      if (seen.depth.at<float>(y, x) > 60.0F || !isSmooth(seen, x, y)) continue;
      const Eigen::Vector2d ray = world::undistort(modelOf(rig, from.side), Eigen::Vector2d(x, y));
      const std::optional<SeenPoint> target =
          project(world, to, T_world_from * (seen.depth.at<float>(y, x) * ray.homogeneous()));
      if (!target) continue;
      const Eigen::Vector2d& p = target->pixel;
      if (p.x() < kMargin || p.y() < kMargin || p.x() > places.cols - 1 - kMargin ||
          p.y() > places.rows - 1 - kMargin)
        continue;
      const int u = static_cast<int>(std::lround(p.x()));
      const int v = static_cast<int>(std::lround(p.y()));
      if (!isSmooth(other, u, v) ||
          std::abs(other.depth.at<float>(v, u) - target->depth) > 0.05 * target->depth)
        continue;
      places.at<cv::Vec2d>(y, x) = cv::Vec2d(p.x(), p.y());
    }
  }
  return places;
}

constexpr int kPatchRadius = 7;  // px

/// One Lucas-Kanade step with gain and offset: solves gain W + offset - I = grad I . d, where W is `to` at
/// `places` minus `shift`. None if a pixel of the patch has no place or the texture is too weak.
std::optional<Eigen::Vector2d> lucasKanadeStep(const cv::Mat& image, const cv::Mat& to, const cv::Mat& places,
                                               const cv::Point& centre, const Eigen::Vector2d& shift) {
  constexpr double kMinTexture = 2.0;  // smaller eigenvalue of the mean structure tensor, grey levels^2
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (int y = centre.y - kPatchRadius; y <= centre.y + kPatchRadius; ++y) {
    for (int x = centre.x - kPatchRadius; x <= centre.x + kPatchRadius; ++x) {
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
  const double pixels = (2 * kPatchRadius + 1) * (2 * kPatchRadius + 1);
  const Eigen::Matrix2d tensor = normal.topLeftCorner<2, 2>() / pixels;
  if (Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(tensor).eigenvalues()[0] < kMinTexture)
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
  for (int y = kPatchRadius + 4; y < image.rows - kPatchRadius - 4; y += kPatchRadius) {
    for (int x = kPatchRadius + 4; x < image.cols - kPatchRadius - 4; x += kPatchRadius) {
      const std::optional<Eigen::Vector2d> first = lucasKanadeStep(image, other, places, {x, y}, {0.0, 0.0});
      if (!first) continue;
      const std::optional<Eigen::Vector2d> second = lucasKanadeStep(image, other, places, {x, y}, *first);
      const cv::Vec2d& place = places.at<cv::Vec2d>(y, x);
      residuals.push_back({{place[0] - x, place[1] - y}, second ? *first + *second : *first});
    }
  }
  return residuals;
}

}  // namespace cartvo::test
