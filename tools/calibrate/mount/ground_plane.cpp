// Ground plane from a rectified pair: stereo matching, RANSAC, direct alignment.
#include "tools/calibrate/mount/ground_plane.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace cartvo::calibrate {
namespace {

/// A point of the disparity image: homogeneous normalised coordinates (x, y, 1) and the disparity, px.
struct DisparityPoint {
  Eigen::Vector3d ray;
  double disparity;
};

using Points = std::vector<DisparityPoint>;

/// Disparities in the lower half of the image, where the ground is, of points near the camera and ahead of
/// it: a road is level only across its lane, and the ground beyond the kerbs is higher.
Points disparityPoints(const cv::Mat& left, const cv::Mat& right, const calib::Rectification& rectification) {
  constexpr int kMaxDisparity = 64, kBlock = 5, kStep = 2;
  constexpr int kFractions = 16;                        // cv::StereoSGBM's results are in 1/16 px
  constexpr double kMaxDepth = 12.0, kHalfWidth = 1.3;  // m
  const auto matcher = cv::StereoSGBM::create(0, kMaxDisparity, kBlock, 8 * kBlock * kBlock,
                                              32 * kBlock * kBlock, 1, 31, 10, 100, 1);
  cv::Mat disparities;
  matcher->compute(left, right, disparities);
  const double focal_baseline = rectification.focal_length * rectification.baseline;
  Points points;
  for (int row = disparities.rows / 2; row < disparities.rows; row += kStep) {
    for (int column = 0; column < disparities.cols; column += kStep) {
      const double disparity = static_cast<double>(disparities.at<std::int16_t>(row, column)) / kFractions;
      const Eigen::Vector3d ray((column - rectification.cx) / rectification.focal_length,
                                (row - rectification.cy) / rectification.focal_length, 1.0);
      const double depth = disparity > 0.0 ? focal_baseline / disparity : kMaxDepth;
      if (depth < kMaxDepth && std::abs(depth * ray.x()) < kHalfWidth) points.push_back({ray, disparity});
    }
  }
  return points;
}

double residual(const DisparityPoint& point, const Eigen::Vector3d& plane) {
  return point.disparity - point.ray.dot(plane);
}

/// Whether a plane in disparity space can be the ground: below the camera, and within 35 degrees of the
/// camera's own down direction.
bool canBeGround(const Eigen::Vector3d& plane, const calib::Rectification& rectification) {
  constexpr double kMinCosine = 0.82, kMinHeight = 0.2, kMaxHeight = 5.0;  // heights in m
  const double norm = plane.norm();
  const double height = rectification.focal_length * rectification.baseline / norm;
  return norm > 0.0 && plane.y() > kMinCosine * norm && height > kMinHeight && height < kMaxHeight;
}

/// The number of points within `bound` (px) of a plane.
int countInliers(const Points& points, const Eigen::Vector3d& plane, double bound) {
  return static_cast<int>(std::count_if(points.begin(), points.end(), [&](const DisparityPoint& point) {
    return std::abs(residual(point, plane)) < bound;
  }));
}

/// RANSAC: the plane through three random points with the most inliers. Zero if none can be the ground.
Eigen::Vector3d searchPlane(const Points& points, const calib::Rectification& rectification) {
  constexpr int kTrials = 150;
  constexpr double kBound = 0.7;  // px
  std::mt19937 random;            // default seed: deterministic
  Eigen::Vector3d best = Eigen::Vector3d::Zero();
  int best_count = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Eigen::Matrix3d rays;
    Eigen::Vector3d disparities;
    for (int i = 0; i < 3; ++i) {
      const DisparityPoint& point = points[random() % points.size()];
      rays.row(i) = point.ray;
      disparities[i] = point.disparity;
    }
    const Eigen::Vector3d plane = rays.fullPivLu().solve(disparities);
    if (!plane.allFinite() || !canBeGround(plane, rectification)) continue;
    const int count = countInliers(points, plane, kBound);
    if (count > best_count) {
      best_count = count;
      best = plane;
    }
  }
  return best;
}

/// Iterated least squares over the inliers, with a shrinking bound.
Eigen::Vector3d refinePlane(const Points& points, Eigen::Vector3d plane) {
  constexpr int kIterations = 5;
  double bound = 0.7;                  // px
  constexpr double kFinalBound = 0.4;  // px
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    for (const DisparityPoint& point : points) {
      if (std::abs(residual(point, plane)) > bound) continue;
      H += point.ray * point.ray.transpose();
      g += point.disparity * point.ray;
    }
    plane = H.ldlt().solve(g);
    bound = std::max(kFinalBound, 0.8 * bound);
  }
  return plane;
}

/// A pixel of the left image on the ground, with its grey value.
struct GroundPixel {
  Eigen::Vector3d ray;
  int row = 0, column = 0;
  double grey = 0.0;
};

std::vector<GroundPixel> groundPixels(const cv::Mat& left, const Points& points, const Eigen::Vector3d& plane,
                                      const calib::Rectification& rectification) {
  constexpr double kBound = 0.7;  // px
  std::vector<GroundPixel> pixels;
  for (const DisparityPoint& point : points) {
    if (std::abs(residual(point, plane)) > kBound) continue;
    const int column =
        static_cast<int>(std::lround(point.ray.x() * rectification.focal_length + rectification.cx));
    const int row =
        static_cast<int>(std::lround(point.ray.y() * rectification.focal_length + rectification.cy));
    pixels.push_back({point.ray, row, column, static_cast<double>(left.at<float>(row, column))});
  }
  return pixels;
}

/// Aligns the right image with the left one over the plane, since semi-global matching has a systematic error
/// of about a tenth of a pixel, which equals a third of a degree of pitch: Gauss-Newton on the plane, a gain
/// and an offset of brightness (B. D. Lucas, T. Kanade, 1981, for a plane in disparity space), with Huber's
/// weights. Both images are smoothed, so that interpolation between pixels adds no bias.
Eigen::Vector3d alignPlane(const cv::Mat& left, const cv::Mat& right, const Points& points,
                           Eigen::Vector3d plane, const calib::Rectification& rectification) {
  using Vector5d = Eigen::Matrix<double, 5, 1>;
  constexpr int kIterations = 8;
  constexpr double kHuber = 6.0;  // grey levels
  cv::Mat smooth_left, smooth_right;
  left.convertTo(smooth_left, CV_32F);
  right.convertTo(smooth_right, CV_32F);
  cv::GaussianBlur(smooth_left, smooth_left, {5, 5}, 1.0);
  cv::GaussianBlur(smooth_right, smooth_right, {5, 5}, 1.0);
  const std::vector<GroundPixel> pixels = groundPixels(smooth_left, points, plane, rectification);
  double gain = 1.0, offset = 0.0;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Eigen::Matrix<double, 5, 5> H = 1e-6 * Eigen::Matrix<double, 5, 5>::Identity();
    Vector5d g = Vector5d::Zero();
    for (const GroundPixel& pixel : pixels) {
      const double at = pixel.column - pixel.ray.dot(plane);
      const int before = static_cast<int>(std::floor(at));
      if (before < 1 || before + 2 >= right.cols) continue;
      const float* const row = smooth_right.ptr<float>(pixel.row);
      // Catmull and Rom's cubic through four pixels, and its slope.
      const double t = at - before;
      const double p0 = row[before - 1], p1 = row[before], p2 = row[before + 1], p3 = row[before + 2];
      const double c1 = 0.5 * (p2 - p0), c2 = p0 - 2.5 * p1 + 2.0 * p2 - 0.5 * p3,
                   c3 = 0.5 * (p3 - p0) + 1.5 * (p1 - p2);
      const double grey = p1 + t * (c1 + t * (c2 + t * c3));
      const double slope = c1 + t * (2.0 * c2 + 3.0 * t * c3);
      const double error = grey - gain * pixel.grey - offset;
      Vector5d J;
      J << -slope * pixel.ray, -pixel.grey, -1.0;
      const double weight = std::min(1.0, kHuber / std::max(1e-9, std::abs(error)));
      H += weight * J * J.transpose();
      g += weight * error * J;
    }
    const Vector5d step = H.ldlt().solve(g);
    plane -= step.head<3>();
    gain -= step[3];
    offset -= step[4];
  }
  return plane;
}

}  // namespace

std::optional<GroundPlane> findGround(const cv::Mat& left, const cv::Mat& right,
                                      const calib::Rectification& rectification) {
  constexpr std::size_t kMinPoints = 500;
  constexpr double kMinShare = 0.5, kBound = 0.7;  // of the points; px
  const Points points = disparityPoints(left, right, rectification);
  if (points.size() < kMinPoints) return std::nullopt;
  const Eigen::Vector3d found = searchPlane(points, rectification);
  if (found.isZero()) return std::nullopt;
  const Eigen::Vector3d plane = alignPlane(left, right, points, refinePlane(points, found), rectification);
  const int inliers = countInliers(points, plane, kBound);
  if (!canBeGround(plane, rectification) || inliers < kMinShare * static_cast<double>(points.size()))
    return std::nullopt;
  return GroundPlane{plane.normalized(), rectification.focal_length * rectification.baseline / plane.norm(),
                     inliers};
}

}  // namespace cartvo::calibrate
