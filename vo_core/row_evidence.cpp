// Vertical disparities regressed on the right camera's rotation and its motion in the image.
#include "vo_core/row_evidence.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "vo_core/median.hpp"

namespace cartvo {
namespace {

using Vector = RowErrors::Vector;
using Matrix = RowErrors::Matrix;

constexpr std::size_t kFewestMatches = 30;
constexpr int kIterations = 4;  // of weights and noise; each takes half of what is left of the first guess's
constexpr double kLeastNoise = 0.02;  // px, of a row
constexpr double kRobustWidth = 2.0;  // standard deviations at which a row has half its weight
// Standard deviations that keep what a pair does not tell near zero: rad, rad, rad, s.
const Vector kConceivable(1e-2, 1e-2, 1e-2, 1e-1);
// rad/s: how well the rates between two pairs' exposures are known. Between left and right exposure the rig
// turns by this times the offset more or less than the poses say.
constexpr double kRateDoubt = 0.02;

/// One stereo match.
struct RowDifference {
  double residual = 0.0;  // px, measured vertical disparity minus predicted
  double weight = 0.0;
  Vector by_errors = Vector::Zero();
};

std::vector<RowDifference> rowDifferences(const BundleProblem& problem) {
  const StereoCamera& camera = problem.camera;
  const int newest = static_cast<int>(problem.poses.size()) - 1;
  const RightCamera right_camera = rightCameraOf(problem.poses, newest, camera.baseline);
  const Eigen::Isometry3d left_inverse = problem.poses.back().T_world_camera.inverse();
  const Eigen::Isometry3d right_inverse = right_camera.T_world_camera.inverse();
  std::vector<RowDifference> differences;
  differences.reserve(problem.landmarks.size());
  for (const BundleLandmark& landmark : problem.landmarks) {
    const BundleSighting& sighting = landmark.sightings.back();
    if (sighting.pose != newest || !sighting.stereo) continue;
    const Eigen::Isometry3d& T_world_host = problem.poses[landmark.sightings.front().pose].T_world_camera;
    const Eigen::Isometry3d T_right_host = right_inverse * T_world_host;
    const Projection left =
        projectLandmark(camera, left_inverse * T_world_host, landmark.bearing, landmark.inverse_depth);
    const Projection right = projectLandmark(camera, T_right_host, landmark.bearing, landmark.inverse_depth);
    if (!left.valid || !right.valid) continue;
    const ProjectionJacobians by =
        projectionJacobians(camera, T_right_host, landmark.bearing, landmark.inverse_depth, right);
    const double f = camera.focal_length;
    const double x = (sighting.right.x() - camera.cx) / f;
    const double y = (sighting.right.y() - camera.cy) / f;
    RowDifference& difference = differences.emplace_back();
    difference.residual = sighting.left.y() - sighting.right.y() - (left.pixel.y() - right.pixel.y());
    difference.weight = landmark.weight;
    difference.by_errors << -f * (1.0 + y * y), f * x, f * x * y,
        -by.by_camera.row(1).dot(right_camera.by_offset.transpose());
  }
  return differences;
}

double noiseOf(const std::vector<RowDifference>& differences, const Vector& errors) {
  std::vector<double> absolute;
  absolute.reserve(differences.size());
  for (const RowDifference& difference : differences)
    absolute.push_back(std::abs(difference.residual - difference.by_errors.dot(errors)));
  return std::max(deviationOf(absolute), kLeastNoise);
}

}  // namespace

RowEvidence rowEvidence(const BundleProblem& adjusted) {
  RowEvidence evidence;
  const std::vector<RowDifference> differences = rowDifferences(adjusted);
  if (differences.size() < kFewestMatches) return evidence;
  const Matrix prior = kConceivable.cwiseAbs2().cwiseInverse().asDiagonal();
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const double noise = noiseOf(differences, evidence.errors);
    Matrix products = Matrix::Zero();
    Vector gradient = Vector::Zero();
    double weights = 0.0;
    for (const RowDifference& difference : differences) {
      const double error = (difference.residual - difference.by_errors.dot(evidence.errors)) / noise;
      const double weight = difference.weight / (1.0 + error * error / (kRobustWidth * kRobustWidth));
      weights += weight;
      products.noalias() += weight * difference.by_errors * difference.by_errors.transpose();
      gradient += weight * difference.residual * difference.by_errors;
    }
    if (!(weights > 0.0)) return {};
    evidence.information = products / (noise * noise);
    evidence.leverage = products / weights;
    evidence.errors = (evidence.information + prior).ldlt().solve(gradient / (noise * noise));
  }
  // (I^-1 + D)^-1 = (1 + I D)^-1 I, where I may be singular.
  const double doubt = kRateDoubt * adjusted.poses.back().offset;
  const Matrix doubts = Vector(doubt * doubt, doubt * doubt, 0.0, 0.0).asDiagonal();
  evidence.information =
      (Matrix::Identity() + evidence.information * doubts).inverse() * evidence.information.eval();
  if (!evidence.errors.allFinite() || !evidence.information.allFinite()) return {};
  return evidence;
}

}  // namespace cartvo
