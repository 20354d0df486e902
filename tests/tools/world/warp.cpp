// The measurement behind the renderer's proof: images against the truth they were rendered from.
#include "tests/tools/world/warp.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "tools/world/lens.hpp"

namespace cartvo::test {
namespace {

constexpr float kInvalid = std::numeric_limits<float>::quiet_NaN();

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

/// Keys' cubic convolution with a = -1/2.
double cubicWeight(double x) {
  x = std::abs(x);
  if (x < 1.0) return (1.5 * x - 2.5) * x * x + 1.0;
  return x < 2.0 ? ((-0.5 * x + 2.5) * x - 4.0) * x + 2.0 : 0.0;
}

double bicubic(const cv::Mat& image, const Eigen::Vector2d& at) {
  const int x0 = static_cast<int>(std::floor(at.x()));
  const int y0 = static_cast<int>(std::floor(at.y()));
  double sum = 0.0;
  for (int y = y0 - 1; y <= y0 + 2; ++y) {
    for (int x = x0 - 1; x <= x0 + 2; ++x) {
      sum += cubicWeight(at.x() - x) * cubicWeight(at.y() - y) * image.at<std::uint8_t>(y, x);
    }
  }
  return sum;
}

/// Planes have an inverse depth that is linear in the image: a bend in it is an edge.
bool smoothAround(const world::DepthImage& seen, int x, int y) {
  constexpr int kReach = 2;
  for (int v = y - kReach; v <= y + kReach; ++v) {
    for (int u = x - kReach; u <= x + kReach; ++u) {
      if (seen.moving.at<std::uint8_t>(v, u) != 0 || seen.depth.at<float>(v, u) <= 0.0F) return false;
    }
  }
  const auto inverse = [&](int u, int v) { return 1.0 / seen.depth.at<float>(v, u); };
  const double own = inverse(x, y);
  const double bend_x = inverse(x - kReach, y) - 2.0 * own + inverse(x + kReach, y);
  const double bend_y = inverse(x, y - kReach) - 2.0 * own + inverse(x, y + kReach);
  return std::abs(bend_x) < 2e-3 * own && std::abs(bend_y) < 2e-3 * own;
}

struct Warped {
  cv::Mat image;  ///< CV_32FC1, NaN where there is nothing to compare
  cv::Mat flow;   ///< CV_32FC2
};

Warped warp(const world::RenderedWorld& world, const Exposure& from, const Exposure& to) {
  const Rig rig = world.rig();
  const world::DepthImage seen = world.renderDepth(from.index, from.side);
  const world::DepthImage other = world.renderDepth(to.index, to.side);
  const cv::Mat image = world.image(to.index, to.side);
  const Eigen::Isometry3d T_to_from = T_world_camera(world, to).inverse() * T_world_camera(world, from);
  Warped warped{cv::Mat(image.size(), CV_32FC1, cv::Scalar(kInvalid)), cv::Mat(image.size(), CV_32FC2)};
  for (int y = 3; y < image.rows - 3; ++y) {
    for (int x = 3; x < image.cols - 3; ++x) {
      if (seen.depth.at<float>(y, x) > 60.0F || !smoothAround(seen, x, y)) continue;
      const Eigen::Vector2d ray = world::undistort(modelOf(rig, from.side), Eigen::Vector2d(x, y));
      const Eigen::Vector3d point = T_to_from * (seen.depth.at<float>(y, x) * ray.homogeneous());
      if (point.z() < 0.5) continue;
      const Eigen::Vector2d p = world::distort(modelOf(rig, to.side), point.hnormalized());
      if (p.x() < 4 || p.y() < 4 || p.x() > image.cols - 5 || p.y() > image.rows - 5) continue;
      const int u = static_cast<int>(std::lround(p.x()));
      const int v = static_cast<int>(std::lround(p.y()));
      if (!smoothAround(other, u, v) || std::abs(other.depth.at<float>(v, u) - point.z()) > 0.05 * point.z())
        continue;
      warped.image.at<float>(y, x) = static_cast<float>(bicubic(image, p));
      warped.flow.at<cv::Vec2f>(y, x) =
          cv::Vec2f(static_cast<float>(p.x() - x), static_cast<float>(p.y() - y));
    }
  }
  return warped;
}

}  // namespace

std::vector<WarpResidual> warpResiduals(const world::RenderedWorld& world, const Exposure& from,
                                        const Exposure& to) {
  constexpr int kHalf = 7;
  constexpr double kLeastTexture = 8.0;  // smaller eigenvalue of the mean structure tensor, grey levels^2
  const cv::Mat image = world.image(from.index, from.side);
  const Warped warped = warp(world, from, to);
  std::vector<WarpResidual> residuals;
  for (int cy = kHalf + 4; cy < image.rows - kHalf - 4; cy += kHalf) {
    for (int cx = kHalf + 4; cx < image.cols - kHalf - 4; cx += kHalf) {
      // One step of Lucas and Kanade's method with gain and offset: gain W + offset - I = grad I . d.
      Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
      Eigen::Vector4d right = Eigen::Vector4d::Zero();
      bool whole = true;
      for (int y = cy - kHalf; y <= cy + kHalf && whole; ++y) {
        for (int x = cx - kHalf; x <= cx + kHalf && whole; ++x) {
          const float w = warped.image.at<float>(y, x);
          whole = !std::isnan(w);
          const double gx = 0.5 * (image.at<std::uint8_t>(y, x + 1) - image.at<std::uint8_t>(y, x - 1));
          const double gy = 0.5 * (image.at<std::uint8_t>(y + 1, x) - image.at<std::uint8_t>(y - 1, x));
          const Eigen::Vector4d row(gx, gy, -w, -1.0);
          normal += row * row.transpose();
          right -= row * image.at<std::uint8_t>(y, x);
        }
      }
      if (!whole) continue;
      const double pixels = (2 * kHalf + 1) * (2 * kHalf + 1);
      const Eigen::Matrix2d tensor = normal.topLeftCorner<2, 2>() / pixels;
      if (Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(tensor).eigenvalues()[0] < kLeastTexture) continue;
      const Eigen::Vector4d solution = normal.ldlt().solve(right);
      const cv::Vec2f flow = warped.flow.at<cv::Vec2f>(cy, cx);
      residuals.push_back({{flow[0], flow[1]}, solution.head<2>()});
    }
  }
  return residuals;
}

}  // namespace cartvo::test
