// Validation of a calibration: views that were held out, rows, moving boards, halves of the views.
#include "calib/solver/cross_validation.hpp"

#include <Eigen/Dense>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include <opencv2/core/utility.hpp>

#include "calib/model/lens.hpp"
#include "calib/solver/stereo_calibration.hpp"
#include "common/statistics.hpp"

namespace cartvo::calib {
namespace {

/// Fits the board's pose to a held-out view. The error is infinite if that fails.
HeldOutView heldOut(const StereoCalibration& trained, const RectifiedPoints& rectified, const BoardView& view,
                    const std::vector<Eigen::Vector2d>& board_corners) {
  constexpr double kHuber = 2.5;  // standard deviations, as in the calibration itself
  HeldOutView result;
  result.vertical_disparities = verticalDisparities(rectified, view);
  const Rig& rig = trained.estimate.rig;
  const auto pose = fitBoardPose(rig, view, board_corners, kHuber * trained.corner_stddev);
  result.rms = pose ? residualRms(viewResiduals(rig, *pose, view, board_corners))
                    : std::numeric_limits<double>::infinity();
  return result;
}

void holdOut(int fold, int folds, const StereoCalibration& calibration, const std::vector<BoardView>& views,
             const std::vector<Eigen::Vector2d>& board_corners, std::vector<HeldOutView>& results) {
  const auto is_held_out = [&](std::size_t i) { return static_cast<int>(i) % folds == fold; };
  RigAndBoards start;
  start.rig = calibration.estimate.rig;
  std::vector<BoardView> others;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (is_held_out(i)) continue;
    others.push_back(views[i]);
    start.T_left_board.push_back(calibration.estimate.T_left_board[i]);
  }
  const StereoCalibration trained = calibrateStereoFrom(start, others, board_corners, calibration.model);
  const RectifiedPoints rectified(trained.estimate.rig);
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (is_held_out(i)) results[i] = heldOut(trained, rectified, views[i], board_corners);
  }
}

void summarise(const std::vector<BoardView>& views, CrossValidation& validation) {
  double squares = 0.0, corners = 0.0, vertical_squares = 0.0;
  std::vector<double> vertical;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const HeldOutView& view = validation.views[i];
    const auto count = static_cast<double>(views[i].left.size() + views[i].right.size());
    squares += view.rms * view.rms * count;
    corners += count;
    for (const double disparity : view.vertical_disparities) {
      vertical.push_back(std::abs(disparity));
      vertical_squares += disparity * disparity;
    }
  }
  validation.rms = std::sqrt(squares / corners);
  if (vertical.empty()) throw std::runtime_error("no corner is seen by both cameras");
  validation.vertical_disparity_rms = std::sqrt(vertical_squares / static_cast<double>(vertical.size()));
  std::sort(vertical.begin(), vertical.end());
  validation.vertical_disparity_p95 = vertical[vertical.size() * 95 / 100];
}

Eigen::Vector2d meanOf(const std::vector<Eigen::Vector2d>& residuals) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& residual : residuals)
    sum += residual;
  return sum / static_cast<double>(std::max<std::size_t>(residuals.size(), 1));
}

constexpr double kMinCosine = 0.5;  // of 60 degrees

Eigen::Vector2d pixelOf(const CameraModel& camera, const Lens& lens, const Eigen::Vector3d& ray) {
  const NormalisedPoint distorted = lens.distort(ray);
  return {camera.fx * distorted.x + camera.cx, camera.fy * distorted.y + camera.cy};
}

std::optional<Eigen::Vector3d> rayOf(const CameraModel& camera, const Lens& lens,
                                     const Eigen::Vector2d& pixel) {
  try {
    const Eigen::Vector3d ray =
        lens.undistort({(pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy})
            .normalized();
    if (ray.z() >= kMinCosine) return ray;
  } catch (const std::invalid_argument&) {  // beyond the radius where the distortion folds
  }
  return std::nullopt;
}

/// The centres of a fine grid, in covered cells.
std::vector<Eigen::Vector2d> gridOf(cv::Size size, const ImageCoverage& coverage) {
  constexpr int kAcross = 24, kDown = 16;
  std::vector<Eigen::Vector2d> grid;
  for (int row = 0; row < kDown; ++row) {
    for (int column = 0; column < kAcross; ++column) {
      const Eigen::Vector2d pixel((column + 0.5) * size.width / kAcross - 0.5,
                                  (row + 0.5) * size.height / kDown - 0.5);
      if (coverage.covers(pixel, size)) grid.push_back(pixel);
    }
  }
  return grid;
}

/// The rotation R that maximises the trace of R^T `products`: with the sum of to * from^T, the one that takes
/// the vectors `from` to `to` best (W. Kabsch, "A solution for the best rotation to relate two sets of
/// vectors", 1976).
Eigen::Matrix3d bestRotation(const Eigen::Matrix3d& products) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(products, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return svd.matrixU() * Eigen::Vector3d(1.0, 1.0, sign).asDiagonal() * svd.matrixV().transpose();
}

/// The rotation that takes the rays of one calibration to those of the other.
Eigen::Matrix3d impliedRotation(const std::vector<Eigen::Vector3d>& from,
                                const std::vector<Eigen::Vector3d>& to) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < from.size(); ++i)
    sum += to[i] * from[i].transpose();
  return bestRotation(sum);
}

void addProjectionDifferences(const CameraModel& a, const CameraModel& b, const ImageCoverage& coverage,
                              std::vector<double>& differences) {
  const Lens lens_a(a), lens_b(b);
  std::vector<Eigen::Vector3d> rays_a, rays_b;
  std::vector<Eigen::Vector2d> pixels;
  for (const Eigen::Vector2d& pixel : gridOf(a.size, coverage)) {
    const auto ray_a = rayOf(a, lens_a, pixel), ray_b = rayOf(b, lens_b, pixel);
    if (!ray_a || !ray_b) continue;
    rays_a.push_back(*ray_a);
    rays_b.push_back(*ray_b);
    pixels.push_back(pixel);
  }
  const Eigen::Matrix3d R_b_a = impliedRotation(rays_a, rays_b);
  for (std::size_t i = 0; i < pixels.size(); ++i)
    differences.push_back((pixelOf(b, lens_b, R_b_a * rays_a[i]) - pixels[i]).norm());
}

/// The distance along the left ray of the point nearest to the right ray.
double triangulated(const Eigen::Vector3d& left_ray, const Eigen::Vector3d& right_ray, const Rig& rig) {
  const Eigen::Isometry3d T_left_right = rig.T_right_left.inverse();
  const Eigen::Vector3d d = T_left_right.linear() * right_ray, centre = T_left_right.translation();
  const double product = left_ray.dot(d);
  return (centre.dot(left_ray) - product * centre.dot(d)) / (1.0 - product * product);
}

/// Infinity without values: calibrations that cannot be compared do not count as equal.
double quantileOrInfinity(const std::vector<double>& values, double share) {
  return values.empty() ? std::numeric_limits<double>::infinity() : quantile(values, share);
}

DepthDifference depthDifference(const Rig& a, const Rig& b, const ImageCoverage& left,
                                const ImageCoverage& right, double distance) {
  const Lens left_a(a.left), right_a(a.right), left_b(b.left), right_b(b.right);
  std::vector<double> differences;
  for (const Eigen::Vector2d& pixel : gridOf(a.left.size, left)) {
    const auto ray_a = rayOf(a.left, left_a, pixel), ray_b = rayOf(b.left, left_b, pixel);
    if (!ray_a || !ray_b) continue;
    const double length = distance / ray_a->z();
    const Eigen::Vector2d in_right = pixelOf(a.right, right_a, a.T_right_left * (length * *ray_a));
    if (!right.covers(in_right, a.right.size)) continue;
    const auto right_ray = rayOf(b.right, right_b, in_right);
    if (!right_ray) continue;
    const double found = triangulated(*ray_b, *right_ray, b) * ray_b->z();
    // Diverging rays: the point is at infinity or beyond.
    differences.push_back(found > 0.0 ? std::abs(found - distance) : distance);
  }
  return {distance, quantileOrInfinity(differences, 0.5), quantileOrInfinity(differences, 0.95)};
}

}  // namespace

RectifiedPoints::RectifiedPoints(const Rig& rig)
    : left_(rig.left),
      right_(rig.right),
      left_lens_(rig.left),
      right_lens_(rig.right),
      rotations_(rectifyingRotations(rig)),
      focal_length_((rig.left.fx + rig.left.fy + rig.right.fx + rig.right.fy) / 4.0) {}

std::optional<Eigen::Vector2d> RectifiedPoints::rectify(const CameraModel& camera, const Lens& lens,
                                                        const Eigen::Matrix3d& rotation,
                                                        const Eigen::Vector2d& raw_pixel) const {
  const NormalisedPoint distorted{(raw_pixel.x() - camera.cx) / camera.fx,
                                  (raw_pixel.y() - camera.cy) / camera.fy};
  Eigen::Vector3d ray;
  try {
    ray = lens.undistort(distorted);
  } catch (const std::invalid_argument&) {  // beyond the radius where the distortion folds
    return std::nullopt;
  }
  ray = rotation * ray;
  constexpr double kMinCosine = 0.34;  // of 70 degrees: further out a plane stretches the image too much
  if (ray.z() < kMinCosine * ray.norm()) return std::nullopt;
  return Eigen::Vector2d(focal_length_ * ray.x() / ray.z(), focal_length_ * ray.y() / ray.z());
}

std::vector<double> verticalDisparities(const RectifiedPoints& rectified, const BoardView& view) {
  std::vector<double> disparities;
  auto right = view.right.begin();
  for (const SeenCorner& left : view.left) {
    while (right != view.right.end() && right->id < left.id)
      ++right;
    if (right == view.right.end() || right->id != left.id) continue;
    const auto in_left = rectified.rectifyLeft(left.pixel);
    const auto in_right = rectified.rectifyRight(right->pixel);
    if (in_left && in_right) disparities.push_back(in_left->y() - in_right->y());
  }
  return disparities;
}

CrossValidation crossValidate(const StereoCalibration& calibration, const std::vector<BoardView>& views,
                              const std::vector<Eigen::Vector2d>& board_corners, int folds) {
  CrossValidation validation;
  validation.views.resize(views.size());
  std::vector<std::string> problems(static_cast<std::size_t>(folds));
  cv::parallel_for_({0, folds}, [&](const cv::Range& range) {
    for (int fold = range.start; fold < range.end; ++fold) {
      try {
        holdOut(fold, folds, calibration, views, board_corners, validation.views);
      } catch (const std::exception& error) {
        problems[static_cast<std::size_t>(fold)] = error.what();
      }
    }
  });
  for (const std::string& problem : problems) {
    if (!problem.empty()) throw std::runtime_error(problem);
  }
  summarise(views, validation);
  return validation;
}

SyncDiagnosis diagnoseSync(const std::vector<ViewResiduals>& residuals, double corner_stddev) {
  constexpr double kGate = 4.0;              // standard deviations of the mean
  constexpr double kMinShift = 0.25;         // px: a smaller shift is harmless
  constexpr double kMaxCosine = -0.8;        // between the mean left and right residual
  constexpr double kMaxOpposedShare = 0.25;  // of the views
  SyncDiagnosis diagnosis;
  for (const ViewResiduals& view : residuals) {
    if (view.left.empty() || view.right.empty()) continue;
    const Eigen::Vector2d left = meanOf(view.left), right = meanOf(view.right);
    const double shift = (left - right).norm();
    const double corners = static_cast<double>(std::min(view.left.size(), view.right.size()));
    const double gate = kGate * corner_stddev * std::sqrt(2.0 / corners);
    if (shift < std::max(gate, kMinShift)) continue;
    if (left.dot(right) > kMaxCosine * left.norm() * right.norm()) continue;
    ++diagnosis.opposed_views;
    diagnosis.max_shift = std::max(diagnosis.max_shift, shift);
  }
  diagnosis.is_fault = diagnosis.opposed_views > kMaxOpposedShare * static_cast<double>(residuals.size());
  return diagnosis;
}

CalibrationDifference compareCalibrations(const Rig& a, const Rig& b, const ImageCoverage& left,
                                          const ImageCoverage& right, const std::vector<double>& distances) {
  std::vector<double> differences;
  addProjectionDifferences(a.left, b.left, left, differences);
  addProjectionDifferences(a.right, b.right, right, differences);
  CalibrationDifference result;
  double squares = 0.0;
  for (const double difference : differences)
    squares += difference * difference;
  result.projection_rms = differences.empty() ? std::numeric_limits<double>::infinity()
                                              : std::sqrt(squares / static_cast<double>(differences.size()));
  result.projection_p95 = quantileOrInfinity(differences, 0.95);
  result.baseline = std::abs(a.baseline() / b.baseline() - 1.0);
  for (const double distance : distances)
    result.depth.push_back(depthDifference(a, b, left, right, distance));
  return result;
}

}  // namespace cartvo::calib
