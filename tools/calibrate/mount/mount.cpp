// Mount of the camera on the cart, from ground observations and motions.
#include "tools/calibrate/mount/mount.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "calib/model/rig.hpp"
#include "common/statistics.hpp"
#include "common/units.hpp"

namespace cartvo::calibrate {
namespace {

// Robust fit of a line, with standard deviations.

/// A measurement y at x and its time. The errors of measurements within the same second count as correlated.
struct TimedSample {
  double seconds = 0.0;
  double x = 0.0, y = 0.0;
};

/// The line y = intercept + slope x, with standard deviations.
struct RobustLine {
  double intercept = 0.0, slope = 0.0;
  double intercept_stddev = 0.0;
  double slope_stddev = 0.0;  ///< infinite if the slope was fixed

  double error(const TimedSample& sample) const { return sample.y - intercept - slope * sample.x; }
};

/// Standard deviation of normal values, from their median absolute deviation.
double robustStddev(const std::vector<double>& values) {
  const double centre = medianOf(values);
  std::vector<double> distances;
  for (const double value : values)
    distances.push_back(std::abs(value - centre));
  return 1.4826 * medianOf(distances);
}

std::vector<double> errorsOf(const std::vector<TimedSample>& samples, const RobustLine& line) {
  std::vector<double> errors;
  for (const TimedSample& sample : samples)
    errors.push_back(line.error(sample));
  return errors;
}

/// One step of least squares, with the weights of the current line.
void updateLine(const std::vector<TimedSample>& samples, bool is_slope_free, RobustLine& line) {
  constexpr double kCauchy = 2.385, kMinScale = 1e-4;
  const std::vector<double> errors = errorsOf(samples, line);
  const double scale = std::max(kMinScale, kCauchy * robustStddev(errors));
  Eigen::Matrix2d H = 1e-12 * Eigen::Matrix2d::Identity();
  Eigen::Vector2d g = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Eigen::Vector2d terms(1.0, is_slope_free ? samples[i].x : 0.0);
    const double weight = 1.0 / (1.0 + errors[i] * errors[i] / (scale * scale));
    H += weight * terms * terms.transpose();
    g += weight * errors[i] * terms;
  }
  const Eigen::Vector2d step = H.ldlt().solve(g);
  line.intercept += step[0];
  if (is_slope_free) line.slope += step[1];
}

/// The median error of each second.
std::vector<double> secondErrors(const std::vector<TimedSample>& samples, const RobustLine& line) {
  std::map<long, std::vector<double>> seconds;
  for (const TimedSample& sample : samples)
    seconds[static_cast<long>(std::floor(sample.seconds))].push_back(line.error(sample));
  std::vector<double> errors;
  for (const auto& [second, values] : seconds)
    errors.push_back(medianOf(values));
  return errors;
}

/// Fits a line by iteratively reweighted least squares with Cauchy's weights (P. W. Holland, R. E. Welsch,
/// "Robust regression using iteratively reweighted least-squares", 1977). The slope is fixed at `slope` if
/// the standard deviation of x (see robustStddev) is below `min_spread`. Standard deviations come from the
/// scatter of the medians of each second. Requires at least one sample.
RobustLine fitRobustLine(const std::vector<TimedSample>& samples, double slope, double min_spread) {
  constexpr int kIterations = 30;
  std::vector<double> xs;
  for (const TimedSample& sample : samples)
    xs.push_back(sample.x);
  const double spread = robustStddev(xs), middle = medianOf(xs);
  const bool is_slope_free = spread > min_spread;
  RobustLine line;
  line.slope = slope;
  for (int iteration = 0; iteration < kIterations; ++iteration)
    updateLine(samples, is_slope_free, line);
  const std::vector<double> errors = secondErrors(samples, line);
  const double mean_stddev = robustStddev(errors) / std::sqrt(static_cast<double>(errors.size()));
  line.slope_stddev = is_slope_free ? mean_stddev / spread : std::numeric_limits<double>::infinity();
  line.intercept_stddev = is_slope_free ? mean_stddev * std::hypot(1.0, middle / spread) : mean_stddev;
  return line;
}

/// R_body_camera from the directions down and forward in camera axes.
Eigen::Matrix3d bodyAxes(const Eigen::Vector3d& down, const Eigen::Vector3d& forward) {
  const Eigen::Vector3d up = -down.normalized();
  const Eigen::Vector3d ahead = (forward - up * up.dot(forward)).normalized();
  Eigen::Matrix3d R_body_camera;
  R_body_camera.row(0) = ahead;
  R_body_camera.row(1) = up.cross(ahead);
  R_body_camera.row(2) = up;
  return R_body_camera;
}

/// Yaw, pitch and roll of a camera relative to one that looks forward, rad.
Eigen::Vector3d anglesOf(const Eigen::Matrix3d& R_body_camera) {
  const Eigen::Matrix3d R = R_body_camera * calib::forwardLookingMount().linear().transpose();
  return {std::atan2(R(1, 0), R(0, 0)), -std::asin(std::clamp(R(2, 0), -1.0, 1.0)),
          std::atan2(R(2, 1), R(2, 2))};
}

/// The normalised median, per component, of the observed normals.
Eigen::Vector3d medianDown(const std::vector<GroundObservation>& ground) {
  Eigen::Vector3d down;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const GroundObservation& observation : ground)
      values.push_back(observation.down[axis]);
    down[axis] = medianOf(values);
  }
  return down.normalized();
}

/// Fits yaw and the distance from the rear axle: the angle between motion and camera axis in the ground plane
/// over the curvature of the path, both positive to the left.
void measureCourse(const std::vector<CameraTwist>& motions, const Eigen::Vector3d& down, double known_ahead,
                   Mount& mount) {
  constexpr double kMinSpeed = 1.0, kMaxCurvature = 0.2;  // m/s; 1/m: a radius of 5 m
  constexpr std::size_t kMinMotions = 20;
  constexpr double kMinSpread = 0.005;  // 1/m
  const Eigen::Matrix3d axes = bodyAxes(down, Eigen::Vector3d::UnitZ());
  std::vector<TimedSample> courses;
  for (const CameraTwist& motion : motions) {
    const Eigen::Vector3d velocity = axes * motion.velocity;
    if (std::abs(velocity.x()) < kMinSpeed) continue;  // forward or backward
    const double curvature = (axes * motion.angular_velocity).z() / velocity.x();
    if (std::abs(curvature) > kMaxCurvature) continue;
    courses.push_back({motion.seconds, curvature, std::atan(velocity.y() / velocity.x())});
  }
  if (courses.size() < kMinMotions) return;
  const RobustLine line = fitRobustLine(courses, known_ahead, kMinSpread);
  mount.yaw = {-line.intercept, line.intercept_stddev};
  if (std::isfinite(line.slope_stddev)) mount.ahead_of_axle = {line.slope, line.slope_stddev};
  mount.motions = static_cast<int>(courses.size());
}

/// Accelerations that pitch and roll a cart on its springs, m/s^2.
struct Accelerations {
  double forward = 0.0, left = 0.0;
};

/// Computes the accelerations from the motions within half a second: the slope of the speed, and speed times
/// yaw rate. Zero if there are too few motions.
Accelerations accelerationsAt(double seconds, const std::vector<CameraTwist>& motions,
                              const Eigen::Matrix3d& axes) {
  constexpr double kHalfWindow = 0.5;  // s
  constexpr int kMinMotions = 4;
  double count = 0.0, t1 = 0.0, t2 = 0.0, v1 = 0.0, tv = 0.0, left = 0.0;
  for (const CameraTwist& motion : motions) {
    const double t = motion.seconds - seconds;
    if (std::abs(t) > kHalfWindow) continue;
    const double speed = (axes * motion.velocity).x();
    count += 1.0;
    t1 += t;
    t2 += t * t;
    v1 += speed;
    tv += t * speed;
    left += speed * (axes * motion.angular_velocity).z();
  }
  if (count < kMinMotions) return {};
  return {(count * tv - t1 * v1) / (count * t2 - t1 * t1), left / count};
}

/// Fits height, pitch and roll at zero acceleration.
void measureAttitude(const std::vector<GroundObservation>& ground, const std::vector<CameraTwist>& motions,
                     const Eigen::Vector3d& down, const Eigen::Vector3d& forward, Mount& mount) {
  constexpr double kMinSpread = 0.1, kNeverFree = 1e9;  // m/s^2; the latter fixes the slope
  const Eigen::Matrix3d axes = bodyAxes(down, forward);
  std::vector<TimedSample> heights, pitches, rolls;
  for (const GroundObservation& observation : ground) {
    const Accelerations acceleration = accelerationsAt(observation.seconds, motions, axes);
    const Eigen::Vector3d angles = anglesOf(bodyAxes(observation.down, forward));
    heights.push_back({observation.seconds, 0.0, observation.height});
    pitches.push_back({observation.seconds, acceleration.forward, angles[1]});
    rolls.push_back({observation.seconds, acceleration.left, angles[2]});
  }
  const RobustLine height = fitRobustLine(heights, 0.0, kNeverFree);
  const RobustLine pitch = fitRobustLine(pitches, 0.0, kMinSpread);
  const RobustLine roll = fitRobustLine(rolls, 0.0, kMinSpread);
  mount.height = {height.intercept, height.intercept_stddev};
  mount.pitch = {pitch.intercept, pitch.intercept_stddev};
  mount.roll = {roll.intercept, roll.intercept_stddev};
}

/// The body's forward direction in camera axes: from the estimated yaw, or that of the known mount.
Eigen::Vector3d forwardOf(const Mount& mount, const Eigen::Vector3d& down,
                          const Eigen::Isometry3d& T_body_camera) {
  if (!mount.yaw) return T_body_camera.linear().row(0);
  const Eigen::Vector3d in_plane(std::cos(mount.yaw->value), -std::sin(mount.yaw->value), 0.0);
  return bodyAxes(down, Eigen::Vector3d::UnitZ()).transpose() * in_plane;
}

}  // namespace

Mount measureMount(const std::vector<GroundObservation>& ground, const std::vector<CameraTwist>& motions,
                   const Eigen::Isometry3d& T_body_camera) {
  constexpr std::size_t kMinGroundObservations = 3;
  if (ground.size() < kMinGroundObservations) {
    throw std::runtime_error("the ground was found in " + std::to_string(ground.size()) +
                             " pairs only: it must fill most of the lower half of the images and have "
                             "texture; with unsynchronised "
                             "cameras the cart must stand still for some of the pairs");
  }
  const Eigen::Vector3d down = medianDown(ground);
  Mount mount;
  mount.ground_observations = static_cast<int>(ground.size());
  measureCourse(motions, down, T_body_camera.translation().x(), mount);
  const Eigen::Vector3d forward = forwardOf(mount, down, T_body_camera);
  measureAttitude(ground, motions, down, forward, mount);
  const double yaw = anglesOf(bodyAxes(down, forward))[0];
  if (mount.yaw) mount.yaw->value = yaw;
  mount.T_body_camera = T_body_camera;
  mount.T_body_camera.translation().z() = mount.height.value;
  mount.T_body_camera.linear() = (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                                  Eigen::AngleAxisd(mount.pitch.value, Eigen::Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(mount.roll.value, Eigen::Vector3d::UnitX()) *
                                  Eigen::Quaterniond(calib::forwardLookingMount().linear()))
                                     .toRotationMatrix();
  return mount;
}

double durationOf(const std::vector<GroundObservation>& ground) {
  if (ground.empty()) return 0.0;
  const auto [first, last] = std::minmax_element(
      ground.begin(), ground.end(),
      [](const GroundObservation& a, const GroundObservation& b) { return a.seconds < b.seconds; });
  return last->seconds - first->seconds;
}

Mount withRoadUncertainty(const Mount& mount, double seconds) {
  constexpr double kReferenceTime = 10.0, kMinTime = 1.0;  // s
  constexpr double kHeight = 0.006;                        // m, in the reference time, as the next
  constexpr double kPitch = 0.15 * kRadiansPerDegree, kYaw = 0.05 * kRadiansPerDegree;
  constexpr double kRoll = 0.15 * kRadiansPerDegree;  // does not average
  const double share = std::sqrt(kReferenceTime / std::max(seconds, kMinTime));
  const auto add = [](Estimate& estimate, double stddev) {
    estimate.stddev = std::hypot(estimate.stddev, stddev);
  };
  Mount wider = mount;
  add(wider.height, share * kHeight);
  add(wider.pitch, share * kPitch);
  add(wider.roll, kRoll);
  if (wider.yaw) add(*wider.yaw, share * kYaw);
  return wider;
}

}  // namespace cartvo::calibrate
