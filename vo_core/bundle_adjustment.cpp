// Gauss-Newton on poses and inverse depths.
#include "vo_core/bundle_adjustment.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "vo_core/median.hpp"

namespace cartvo {
namespace {

constexpr double kSettled = 1e-6;           // m and rad: the step that ends the iterations
constexpr double kMedianOfNormal = 0.6745;  // of |e| for a standard normal e
constexpr int kRowPoses = 4;                // poses that one residual depends on at most
constexpr double kLeastDepthInformation = 1e-9;
constexpr double kNotSeen = 1e3;  // error of a landmark behind a camera

using RowVector6d = Eigen::Matrix<double, 1, 6>;
constexpr int kShared = RigCorrection::kSize + 1;  // the rig's correction, and the window's scale
using SharedVector = Eigen::Matrix<double, kShared, 1>;
using SharedMatrix = Eigen::Matrix<double, kShared, kShared>;

/// One residual, linearised: its derivative by some poses and by the landmark's inverse depth.
struct Row {
  double residual = 0.0;  // measured minus predicted, in standard deviations
  double weight = 0.0;
  double by_inverse_depth = 0.0;
  SharedVector by_shared = SharedVector::Zero();
  double by_late_right = 0.0;  ///< the right camera's later exposure itself, not what it did to earlier poses
  int poses = 0;
  std::array<int, kRowPoses> pose{};
  std::array<RowVector6d, kRowPoses> by_pose{RowVector6d::Zero(), RowVector6d::Zero(), RowVector6d::Zero(),
                                             RowVector6d::Zero()};

  void add(int index, const RowVector6d& derivative) {
    for (int i = 0; i < poses; ++i) {
      if (pose[i] != index) continue;
      by_pose[i] += derivative;
      return;
    }
    pose[poses] = index;
    by_pose[poses++] = derivative;
  }
};

double robustWeight(double squared_error, double width) {
  return 1.0 / (1.0 + squared_error / (width * width));
}

/// The cameras of a problem, each left and right one as seen from each left one.
class Cameras {
 public:
  Cameras(const std::vector<TimedPose>& poses, double baseline) : count_(static_cast<int>(poses.size())) {
    for (int i = 0; i < count_; ++i)
      right_.push_back(rightCameraOf(poses, i, baseline));
    for (int camera = 0; camera < count_; ++camera) {
      const Eigen::Isometry3d left_inverse = poses[camera].T_world_camera.inverse();
      const Eigen::Isometry3d right_inverse = right_[camera].T_world_camera.inverse();
      for (int host = 0; host < count_; ++host) {
        T_left_host_.push_back(left_inverse * poses[host].T_world_camera);
        T_right_host_.push_back(right_inverse * poses[host].T_world_camera);
      }
    }
  }
  const Eigen::Isometry3d& leftFromHost(int camera, int host) const {
    return T_left_host_[camera * count_ + host];
  }
  const Eigen::Isometry3d& rightFromHost(int camera, int host) const {
    return T_right_host_[camera * count_ + host];
  }
  const RightCamera& right(int camera) const { return right_[camera]; }

 private:
  int count_;
  std::vector<RightCamera> right_;
  std::vector<Eigen::Isometry3d> T_left_host_, T_right_host_;
};

/// The residuals of one landmark.
class LandmarkRows {
 public:
  LandmarkRows(const BundleProblem& problem, const Cameras& cameras, double robust_width)
      : problem_(problem), cameras_(cameras), robust_width_(robust_width) {}

  /// False if a camera has the landmark behind it.
  bool linearise(const BundleLandmark& landmark) {
    rows_.clear();
    const int host = landmark.sightings.front().pose;
    for (std::size_t i = 0; i < landmark.sightings.size(); ++i)
      if (!addSighting(landmark, landmark.sightings[i], host, i == 0)) return false;
    return true;
  }
  const std::vector<Row>& rows() const { return rows_; }

 private:
  bool addSighting(const BundleLandmark& landmark, const BundleSighting& sighting, int host, bool is_host) {
    const StereoCamera& camera = problem_.camera;
    const Eigen::Isometry3d& T_left_host = cameras_.leftFromHost(sighting.pose, host);
    const Projection left = projectLandmark(camera, T_left_host, landmark.bearing, landmark.inverse_depth);
    if (!left.valid) return false;
    const ProjectionJacobians by =
        projectionJacobians(camera, T_left_host, landmark.bearing, landmark.inverse_depth, left);
    if (!is_host) {
      const double precision = 1.0 / problem_.noise.pixel;
      const Eigen::Vector2d error = precision * (sighting.left - left.pixel);
      const double weight = landmark.weight * robustWeight(0.5 * error.squaredNorm(), robust_width_);
      for (int axis = 0; axis < 2; ++axis) {
        Row& row = rows_.emplace_back();
        row.residual = error[axis];
        row.weight = weight;
        row.by_inverse_depth = precision * by.by_inverse_depth[axis];
        row.add(sighting.pose, precision * by.by_camera.row(axis));
        row.add(host, precision * by.by_host.row(axis));
      }
    }
    return !sighting.stereo || addDisparity(landmark, sighting, host, is_host, left, by);
  }

  bool addDisparity(const BundleLandmark& landmark, const BundleSighting& sighting, int host, bool is_host,
                    const Projection& left, const ProjectionJacobians& by_left) {
    const Eigen::Isometry3d& T_right_host = cameras_.rightFromHost(sighting.pose, host);
    const Projection right =
        projectLandmark(problem_.camera, T_right_host, landmark.bearing, landmark.inverse_depth);
    if (!right.valid) return false;
    const ProjectionJacobians by =
        projectionJacobians(problem_.camera, T_right_host, landmark.bearing, landmark.inverse_depth, right);
    const RightCamera& right_camera = cameras_.right(sighting.pose);

    const double precision =
        1.0 / (problem_.noise.disparity + problem_.noise.stretch * std::abs(sighting.disparity()));
    Row& row = rows_.emplace_back();
    row.residual = precision * (sighting.disparity() - (left.pixel.x() - right.pixel.x()));
    row.weight = landmark.weight * robustWeight(row.residual * row.residual, robust_width_);
    row.by_inverse_depth = precision * (by_left.by_inverse_depth.x() - by.by_inverse_depth.x());
    row.by_shared.head<RigCorrection::kSize>() =
        precision * columnByCorrection(problem_.camera, sighting.right);
    // Predicted, not measured: the noise of what is measured would take part in its own derivative, and a
    // bias come of it. Of the disparity, what the baseline makes; what the motion since the left exposure
    // makes scales with the window.
    row.by_shared[RigCorrection::kSize] = precision * problem_.camera.focal_length *
                                          problem_.camera.baseline * landmark.inverse_depth / right.ray.z();
    if (!is_host) {
      row.add(sighting.pose, precision * by_left.by_camera.row(0));
      row.add(host, precision * by_left.by_host.row(0));
    }
    const RowVector6d by_right = -precision * by.by_camera.row(0);
    row.add(sighting.pose, by_right * right_camera.by_own);
    if (right_camera.neighbour >= 0) row.add(right_camera.neighbour, by_right * right_camera.by_neighbour);
    if (right_camera.third >= 0) row.add(right_camera.third, by_right * right_camera.by_third);
    row.add(host, -precision * by.by_host.row(0));
    row.by_late_right = by_right.dot(right_camera.by_offset.transpose());
    return true;
  }

  const BundleProblem& problem_;
  const Cameras& cameras_;
  double robust_width_;
  std::vector<Row> rows_;
};

/// How one landmark's inverse depth hangs together with the poses.
struct DepthEquation {
  double hessian = 0.0;
  double gradient = 0.0;
  Eigen::VectorXd by_poses;
};

/// The normal equations, the inverse depths eliminated.
class ReducedSystem {
 public:
  explicit ReducedSystem(const BundleProblem& problem)
      : fixed_(problem.fixed), size_(6 * (static_cast<int>(problem.poses.size()) - problem.fixed)) {}

  /// `visit(i, rows, depth)` sees each landmark's residuals, and none of one behind a camera.
  template <typename Visit>
  void build(const BundleProblem& problem, const Cameras& cameras, double robust_width, const Visit& visit) {
    hessian = Eigen::MatrixXd::Zero(size_, size_);
    gradient = Eigen::VectorXd::Zero(size_);
    depths.assign(problem.landmarks.size(), {});
    LandmarkRows rows(problem, cameras, robust_width);
    for (std::size_t i = 0; i < problem.landmarks.size(); ++i) {
      if (!rows.linearise(problem.landmarks[i])) continue;
      add(problem.landmarks[i], rows.rows(), depths[i]);
      visit(i, rows.rows(), depths[i]);
    }
    hessian.triangularView<Eigen::StrictlyUpper>() = hessian.transpose();
  }

  Eigen::MatrixXd hessian;
  Eigen::VectorXd gradient;
  std::vector<DepthEquation> depths;

 private:
  void add(const BundleLandmark& landmark, const std::vector<Row>& rows, DepthEquation& depth) {
    depth.by_poses = Eigen::VectorXd::Zero(size_);
    depth.hessian = landmark.prior_information;
    depth.gradient = landmark.prior_information * (landmark.prior_inverse_depth - landmark.inverse_depth);
    for (const Row& row : rows) {
      depth.hessian += row.weight * row.by_inverse_depth * row.by_inverse_depth;
      depth.gradient += row.weight * row.by_inverse_depth * row.residual;
      for (int a = 0; a < row.poses; ++a) {
        const int at_a = 6 * (row.pose[a] - fixed_);
        if (at_a < 0) continue;
        const RowVector6d weighted = row.weight * row.by_pose[a];
        gradient.segment<6>(at_a) += weighted.transpose() * row.residual;
        depth.by_poses.segment<6>(at_a) += weighted.transpose() * row.by_inverse_depth;
        for (int b = 0; b < row.poses; ++b) {
          const int at_b = 6 * (row.pose[b] - fixed_);
          if (at_b < 0 || at_b > at_a) continue;
          hessian.block<6, 6>(at_a, at_b).noalias() += weighted.transpose() * row.by_pose[b];
        }
      }
    }
    if (depth.hessian < kLeastDepthInformation) {
      depth.hessian = 0.0;
      return;
    }
    hessian.selfadjointView<Eigen::Lower>().rankUpdate(depth.by_poses, -1.0 / depth.hessian);
    gradient -= depth.by_poses * (depth.gradient / depth.hessian);
  }

  int fixed_;
  int size_;
};

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

/// What the residuals say of the rig's correction and the window's scale, the inverse depths eliminated.
class RigSystem {
 public:
  explicit RigSystem(const BundleProblem& problem)
      : fixed_(problem.fixed),
        by_poses_(CrossMatrix::Zero(6 * (static_cast<int>(problem.poses.size()) - problem.fixed), kShared)) {}

  void add(const std::vector<Row>& rows, const DepthEquation& depth) {
    if (!(depth.hessian > 0.0)) return;
    SharedVector by_depth = SharedVector::Zero();
    for (const Row& row : rows) {
      const SharedVector weighted = row.weight * row.by_shared;
      hessian_ += weighted * row.by_shared.transpose();
      gradient_ += weighted * row.residual;
      by_depth += weighted * row.by_inverse_depth;
      for (int a = 0; a < row.poses; ++a)
        if (const int at = 6 * (row.pose[a] - fixed_); at >= 0)
          by_poses_.middleRows<6>(at) += row.by_pose[a].transpose() * weighted.transpose();
    }
    hessian_ -= by_depth * by_depth.transpose() / depth.hessian;
    gradient_ -= by_depth * (depth.gradient / depth.hessian);
    by_poses_ -= depth.by_poses * (by_depth.transpose() / depth.hessian);
  }

  /// Eliminates the poses and the scale.
  void conclude(const ReducedSystem& system, const Eigen::LDLT<Eigen::MatrixXd>& factor,
                BundleResult& result) const {
    const CrossMatrix solved = factor.solve(by_poses_);
    SharedMatrix hessian = hessian_ - by_poses_.transpose() * solved;
    const SharedVector gradient = gradient_ - solved.transpose() * system.gradient;
    constexpr double kScaleInformation = 1.0 / (0.05 * 0.05);
    hessian(kShared - 1, kShared - 1) += kScaleInformation;
    constexpr int n = RigCorrection::kSize;
    const RigCorrection::Vector by_scale = hessian.topRightCorner<n, 1>();
    result.rig_information = hessian.topLeftCorner<n, n>() - by_scale * by_scale.transpose() / hessian(n, n);
    result.rig_gradient = gradient.head<n>() - by_scale * (gradient[n] / hessian(n, n));
  }

 private:
  using CrossMatrix = Eigen::Matrix<double, Eigen::Dynamic, kShared>;
  int fixed_;
  SharedMatrix hessian_ = SharedMatrix::Zero();
  SharedVector gradient_ = SharedVector::Zero();
  CrossMatrix by_poses_;
};

/// How the result errs if all right cameras were exposed later than their offsets say. With the state x, the
/// unmodelled delay d, the residuals z - h(x, d) and the poses that stand wrong by P d already (H: the
/// Hessian),
///
///   dx = H^-1 J^T W (dh/dd - J_standing P) d:
///
/// the consideration of a parameter that is not estimated (S. Schmidt, "Application of state-space methods to
/// navigation problems", 1966).
class LateRight {
 public:
  explicit LateRight(const BundleProblem& problem)
      : problem_(problem),
        by_poses_(Eigen::VectorXd::Zero(6 * (static_cast<int>(problem.poses.size()) - problem.fixed))),
        by_depth_(problem.landmarks.size(), 0.0) {}

  void add(std::size_t landmark, const std::vector<Row>& rows, const DepthEquation& depth) {
    if (!(depth.hessian > 0.0)) return;
    const BundleLandmark& item = problem_.landmarks[landmark];
    double by_depth = item.prior_information * item.prior_by_late_right;
    for (const Row& row : rows) {
      double by_delay = row.by_late_right;
      for (int a = 0; a < row.poses; ++a)
        if (row.pose[a] < problem_.fixed)
          by_delay -= row.by_pose[a].dot(problem_.poses[row.pose[a]].by_late_right.transpose());
      const double weighted = row.weight * by_delay;
      by_depth += weighted * row.by_inverse_depth;
      for (int a = 0; a < row.poses; ++a)
        if (const int at = 6 * (row.pose[a] - problem_.fixed); at >= 0)
          by_poses_.segment<6>(at) += weighted * row.by_pose[a].transpose();
    }
    by_poses_ -= depth.by_poses * (by_depth / depth.hessian);
    by_depth_[landmark] = by_depth;
  }

  void conclude(const Eigen::LDLT<Eigen::MatrixXd>& factor, const std::vector<DepthEquation>& depths,
                BundleProblem& problem) const {
    const Eigen::VectorXd by_delay = factor.solve(by_poses_);
    for (std::size_t i = static_cast<std::size_t>(problem.fixed); i < problem.poses.size(); ++i)
      problem.poses[i].by_late_right =
          by_delay.segment<6>(6 * (static_cast<Eigen::Index>(i) - problem.fixed));
    for (std::size_t i = 0; i < depths.size(); ++i)
      if (depths[i].hessian > 0.0)
        problem.landmarks[i].by_late_right =
            (by_depth_[i] - depths[i].by_poses.dot(by_delay)) / depths[i].hessian;
  }

 private:
  const BundleProblem& problem_;
  Eigen::VectorXd by_poses_;
  std::vector<double> by_depth_;
};

/// How large the residuals are, of all landmarks and of each one's last sighting.
class ResidualSizes {
 public:
  /// The landmark's rows come in the order of its sightings: two of the left position, but for the host, and
  /// one of the disparity.
  void add(const std::vector<Row>& rows, BundleLandmark& landmark) {
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
    return absolute.empty() ? 1.0 : median(absolute) / kMedianOfNormal;
  }
  std::vector<double> pixels_, disparities_;
};

}  // namespace

BundleResult adjustBundle(BundleProblem& problem, const BundleSettings& settings) {
  BundleResult result;
  ReducedSystem system(problem);
  for (int iteration = 0; iteration < settings.iterations; ++iteration) {
    const Cameras cameras(problem.poses, problem.camera.baseline);
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
  const Cameras cameras(problem.poses, problem.camera.baseline);
  system.build(problem, cameras, settings.robust_width,
               [&](std::size_t i, const std::vector<Row>& rows, const DepthEquation& depth) {
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
