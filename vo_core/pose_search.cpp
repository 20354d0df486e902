// The pose that most of the landmarks agree on.
#include "vo_core/pose_search.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace cartvo {
namespace {

constexpr int kSubset = 4;         // points; three would do, the fourth steadies the steps
constexpr int kSubsetSteps = 4;    // Gauss-Newton steps of a subset
constexpr int kPolishSteps = 4;    // and of all that a pose explains
constexpr int kScored = 300;       // points that a subset's pose is judged by
constexpr double kSettled = 1e-5;  // m and rad
constexpr double kNeverExplained = 1e3;

/// Residual of one point, measured minus predicted, whitened, and its derivative by the current pose.
struct PointResidual {
  bool valid = false;
  Eigen::Vector2d residual = Eigen::Vector2d::Zero();
  Eigen::Matrix<double, 2, 6> by_pose = Eigen::Matrix<double, 2, 6>::Zero();

  double error() const { return valid ? residual.norm() / std::sqrt(2.0) : kNeverExplained; }
};

/// The points under one current pose.
class PointModel {
 public:
  PointModel(const PoseProblem& problem, const Eigen::Isometry3d& T_world_camera) : problem_(problem) {
    const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
    for (const Eigen::Isometry3d& host : problem.hosts)
      T_camera_host_.push_back(T_camera_world * host);
  }

  PointResidual at(const PosePoint& point) const {
    PointResidual result;
    const Eigen::Isometry3d& T = T_camera_host_[point.host];
    const Projection seen = projectLandmark(problem_.camera, T, point.bearing, point.inverse_depth);
    if (!seen.valid) return result;
    const ProjectionJacobians by =
        projectionJacobians(problem_.camera, T, point.bearing, point.inverse_depth, seen);
    result.valid = true;
    // Whitened by the Cholesky factor of the covariance, that of the depth included.
    const double noise = problem_.pixel_noise * problem_.pixel_noise;
    const Eigen::Vector2d by_depth = by.by_inverse_depth * point.inverse_depth_deviation;
    const double first = std::sqrt(noise + by_depth.x() * by_depth.x());
    const double both = by_depth.x() * by_depth.y() / first;
    const double second = std::sqrt(noise + by_depth.y() * by_depth.y() - both * both);
    const Eigen::Vector2d error = point.left - seen.pixel;
    result.residual.x() = error.x() / first;
    result.residual.y() = (error.y() - both * result.residual.x()) / second;
    result.by_pose.row(0) = by.by_camera.row(0) / first;
    result.by_pose.row(1) = (by.by_camera.row(1) - both * result.by_pose.row(0)) / second;
    return result;
  }

 private:
  const PoseProblem& problem_;
  std::vector<Eigen::Isometry3d> T_camera_host_;
};

/// One Gauss-Newton step on some of the points; nothing if they leave the pose open.
std::optional<Eigen::Isometry3d> step(const PoseProblem& problem, const std::vector<int>& chosen,
                                      const Eigen::Isometry3d& pose, double gate, Vector6d& change) {
  const PointModel model(problem, pose);
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  for (const int index : chosen) {
    const PosePoint& point = problem.points[index];
    const PointResidual at = model.at(point);
    if (!at.valid) continue;
    const double error = at.error();
    if (gate > 0.0 && error > gate) continue;
    const double weight = gate > 0.0 ? point.weight / (1.0 + error * error / (gate * gate)) : 1.0;
    hessian.noalias() += weight * at.by_pose.transpose() * at.by_pose;
    gradient.noalias() += weight * at.by_pose.transpose() * at.residual;
  }
  const Eigen::LDLT<Matrix6d> factor(hessian);
  const auto pivots = factor.vectorD();
  if (factor.info() != Eigen::Success || !(pivots.minCoeff() > 1e-10 * pivots.maxCoeff()))
    return std::nullopt;
  change = factor.solve(gradient);
  if (!change.allFinite()) return std::nullopt;
  return orthonormalised(pose * motionFromVector(change));
}

std::optional<Eigen::Isometry3d> iterate(const PoseProblem& problem, const std::vector<int>& chosen,
                                         Eigen::Isometry3d pose, double gate, int steps) {
  for (int i = 0; i < steps; ++i) {
    Vector6d change;
    const auto next = step(problem, chosen, pose, gate, change);
    if (!next) return std::nullopt;
    pose = *next;
    if (change.lpNorm<Eigen::Infinity>() < kSettled) break;
  }
  return pose;
}

/// Weight of what a pose explains, a point counting the less the worse it fits.
double support(const PoseProblem& problem, const std::vector<int>& judges, const Eigen::Isometry3d& pose,
               double gate) {
  const PointModel model(problem, pose);
  double sum = 0.0;
  for (const int index : judges) {
    const double error = model.at(problem.points[index]).error();
    sum += problem.points[index].weight * std::max(0.0, 1.0 - error * error / (gate * gate));
  }
  return sum;
}

class Search {
 public:
  Search(const PoseProblem& problem, const PoseSearchSettings& settings, SubsetRandom& random)
      : problem_(problem), settings_(settings), random_(random), start_(problem.start) {
    const int count = static_cast<int>(problem.points.size());
    for (int i = 0; i < count; ++i) {
      all_.push_back(i);
      weight_ += problem.points[i].weight;
    }
    const int stride = std::max(count / kScored, 1);
    for (int i = 0; i < count; i += stride)
      judges_.push_back(i);
  }

  std::optional<FoundPose> run() {
    consider(start_);
    if (const auto polished = iterate(problem_, all_, start_, 3.0 * settings_.gate, kPolishSteps))
      consider(*polished);
    if (best_support_ < settings_.enough * judgesWeight()) drawSubsets();
    if (best_support_ < 0.0) return std::nullopt;
    for (const double gate : {2.0 * settings_.gate, settings_.gate})
      if (const auto polished = iterate(problem_, all_, best_, gate, kPolishSteps);
          polished && admissible(*polished))
        best_ = *polished;
    return conclude();
  }

 private:
  void drawSubsets() {
    std::vector<int> subset;
    for (int i = 0; i < settings_.subsets; ++i) {
      subset.clear();
      while (static_cast<int>(subset.size()) < kSubset) {
        const int index = std::min(static_cast<int>(random_.uniform() * static_cast<double>(all_.size())),
                                   static_cast<int>(all_.size()) - 1);
        if (std::find(subset.begin(), subset.end(), index) == subset.end()) subset.push_back(index);
      }
      if (const auto pose = iterate(problem_, subset, start_, 0.0, kSubsetSteps)) consider(*pose);
    }
  }

  void consider(const Eigen::Isometry3d& pose) {
    if (!admissible(pose)) return;
    const double found = support(problem_, judges_, pose, 2.0 * settings_.gate);  // a subset's pose is blunt
    if (found <= best_support_) return;
    best_support_ = found;
    best_ = pose;
  }

  bool admissible(const Eigen::Isometry3d& pose) const {
    if (!problem_.admissible_change) return true;
    const Vector6d change = vectorFromMotion(start_.inverse() * pose);
    return (change.cwiseAbs().array() <= problem_.admissible_change->array()).all();
  }

  double judgesWeight() const {
    double sum = 0.0;
    for (const int index : judges_)
      sum += problem_.points[index].weight;
    return sum;
  }

  FoundPose conclude() const {
    FoundPose found;
    found.T_world_camera = best_;
    const std::vector<double> errors = pointErrors(problem_, best_);
    double explained = 0.0;
    for (std::size_t i = 0; i < errors.size(); ++i) {
      found.inlier.push_back(errors[i] < settings_.gate);
      if (!found.inlier.back()) continue;
      ++found.inliers;
      explained += problem_.points[i].weight;
    }
    found.share = weight_ > 0.0 ? explained / weight_ : 0.0;
    return found;
  }

  const PoseProblem& problem_;
  const PoseSearchSettings& settings_;
  SubsetRandom& random_;
  Eigen::Isometry3d start_;
  std::vector<int> all_, judges_;
  double weight_ = 0.0;
  double best_support_ = -1.0;
  Eigen::Isometry3d best_ = Eigen::Isometry3d::Identity();
};

}  // namespace

std::vector<double> pointErrors(const PoseProblem& problem, const Eigen::Isometry3d& T_world_camera) {
  const PointModel model(problem, T_world_camera);
  std::vector<double> errors;
  errors.reserve(problem.points.size());
  for (const PosePoint& point : problem.points)
    errors.push_back(model.at(point).error());
  return errors;
}

std::optional<FoundPose> findPose(const PoseProblem& problem, const PoseSearchSettings& settings,
                                  SubsetRandom& random) {
  if (static_cast<int>(problem.points.size()) <= kSubset) return std::nullopt;
  return Search(problem, settings, random).run();
}

}  // namespace cartvo
