// Gauss-Newton on poses and inverse depths.
#include "vo_core/bundle_adjustment.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "vo_core/late_right.hpp"
#include "vo_core/median.hpp"
#include "vo_core/rig_system.hpp"

namespace cartvo {
namespace {

constexpr double kSettled = 1e-5;  // m and rad: the step that ends the iterations
constexpr double kNotSeen = 1e3;   // error of a landmark behind a camera

void applyStep(const Eigen::VectorXd& step, const std::vector<DepthEquation>& depths,
               BundleProblem& problem) {
  for (std::size_t i = static_cast<std::size_t>(problem.fixed); i < problem.poses.size(); ++i) {
    Eigen::Isometry3d& pose = problem.poses[i].T_world_camera;
    pose = orthonormalised(
        pose * motionFromVector(step.segment<6>(6 * (static_cast<Eigen::Index>(i) - problem.fixed))));
  }
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const DepthEquation& depth = depths[i];
    if (depth.hessian > 0.0)
      problem.landmarks[i].inverse_depth += (depth.gradient - depth.by_poses.dot(step)) / depth.hessian;
  }
}

/// How large the residuals are, of all landmarks and of each one's last sighting.
class ResidualSizes {
 public:
  /// The landmark's rows come in the order of its sightings: two of the left position, but for the host, and
  /// one of the disparity.
  void add(const std::vector<BundleRow>& rows, BundleLandmark& landmark) {
    std::size_t next = 0;
    double squares = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < landmark.sightings.size(); ++i) {
      squares = 0.0;
      count = 0;
      const auto take = [&](std::vector<double>& into) {
        const double residual = rows[next++].residual;
        into.push_back(std::abs(residual));
        squares += residual * residual;
        ++count;
      };
      if (i > 0) {
        take(pixels_);
        take(pixels_);
      }
      if (landmark.sightings[i].stereo) take(disparities_);
    }
    landmark.error = count > 0 ? std::sqrt(squares / count) : 0.0;
  }

  void conclude(BundleResult& result) {
    result.pixel_scale = scaleOf(pixels_);
    result.disparity_scale = scaleOf(disparities_);
  }

 private:
  static double scaleOf(std::vector<double>& absolute) {
    return absolute.empty() ? 1.0 : deviationOf(absolute);
  }
  std::vector<double> pixels_, disparities_;
};

}  // namespace

BundleResult adjustBundle(BundleProblem& problem, const BundleSettings& settings) {
  BundleResult result;
  ReducedSystem system(problem);
  for (int iteration = 0; iteration < settings.iterations; ++iteration) {
    const BundleCameras cameras(problem.poses, problem.camera.baseline);
    system.build(problem, cameras, settings.robust_width, [](auto&&...) {});
    const Eigen::LDLT<Eigen::MatrixXd> factor(system.hessian);
    const auto pivots = factor.vectorD();
    if (factor.info() != Eigen::Success || !(pivots.minCoeff() > 1e-9 * pivots.maxCoeff())) return result;
    const Eigen::VectorXd step = factor.solve(system.gradient);
    if (!step.allFinite()) return result;
    applyStep(step, system.depths, problem);
    if (step.lpNorm<Eigen::Infinity>() < kSettled) break;
  }
  for (BundleLandmark& landmark : problem.landmarks)
    landmark.error = kNotSeen;
  RigSystem rig(problem);
  LateRight late_right(problem);
  ResidualSizes sizes;
  const BundleCameras cameras(problem.poses, problem.camera.baseline);
  system.build(problem, cameras, settings.robust_width,
               [&](std::size_t i, const std::vector<BundleRow>& rows, const DepthEquation& depth) {
                 problem.landmarks[i].information = depth.hessian;
                 sizes.add(rows, problem.landmarks[i]);
                 rig.add(rows, depth);
                 late_right.add(i, rows, depth);
               });
  const Eigen::LDLT<Eigen::MatrixXd> factor(system.hessian);
  result.covariance = factor.solve(Eigen::MatrixXd::Identity(system.hessian.rows(), system.hessian.cols()));
  if (!result.covariance.allFinite()) return result;
  sizes.conclude(result);
  rig.conclude(system, factor, result);
  late_right.conclude(factor, system.depths, problem);
  result.converged = true;
  return result;
}

}  // namespace cartvo
