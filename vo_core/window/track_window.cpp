// Sliding window of a track: which landmarks go on, end and come; marginalisation.
#include "vo_core/window/track_window.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "vo_core/fixed_constants.hpp"
#include "vo_core/geometry/reprojection.hpp"
#include "vo_core/geometry/rig_correction.hpp"

namespace cartvo::vo {
namespace {

constexpr double kLeastJerk = 1.0;     // m/s^3 and rad/s^3
constexpr double kJerkFreedom = 6.0;   // of the first values
constexpr double kGaugeStddev = 1e-6;  // m and rad, of a track's first pose
constexpr double kLeastStddev = 1e-8;  // of a shared state that is known
constexpr double kMargin = 5e-3;       // s, that the trajectory exceeds the rows by
constexpr double kReadoutRoom = 1.3;   // of a readout that may grow
constexpr int kMostKnots = 96;
constexpr int kMostKnotsOfStart = 60;
constexpr double kKnotsOfPair = 3.0;     // a mount that shakes at 8 Hz needs them
constexpr double kLongestReadout = 0.1;  // s
constexpr int kPairsOfStart = 5;         // whose values are far from the solution
constexpr std::array<double, 6> kStartScales{8.0, 4.0, 2.0, 1.0, 1.0, 1.0};
constexpr std::array<double, 2> kPredictionScales{3.0, 1.0};  // of left positions only
constexpr std::array<double, 2> kScales{1.0, 1.0};

/// s, from the exposure of the left image to the earliest and the latest row of a pair.
struct Reach {
  double before, after;
};
Reach reachOf(const SharedVector& shared, double offset) {
  const double half =
      0.5 * kReadoutRoom * std::max(std::abs(shared[kLeftReadout]), std::abs(shared[kRightReadout]));
  return {half + kMargin + std::max(0.0, -offset), half + kMargin + std::max(0.0, offset)};
}

/// s, of the left exposures.
std::vector<double> timesOf(std::span<const WindowFrame> window, std::int64_t epoch_ns) {
  std::vector<double> times;
  for (const WindowFrame& frame : window)
    times.push_back(1e-9 * static_cast<double>(frame.exposure_ns - epoch_ns));
  return times;
}

/// Pose at a time (s) by those of a window: between pairs by their motion, beyond them at constant velocity.
Eigen::Isometry3d poseOf(std::span<const WindowFrame> window, const std::vector<double>& times, double time) {
  const auto after = std::upper_bound(times.begin() + 1, times.end() - 1, time);
  const auto i = static_cast<std::size_t>(after - times.begin());
  const Eigen::Isometry3d& from = window[i - 1].T_world_camera;
  const double share = (time - times[i - 1]) / (times[i] - times[i - 1]);
  return orthonormalised(
      from * motionFromVector(share * vectorFromMotion(from.inverse() * window[i].T_world_camera)));
}

/// The motion about an instant, exact there and half a readout before and after it.
ExposureMotion motionAt(const Trajectory& trajectory, double time, double range) {
  const Trajectory::Instant at = trajectory.at(time);
  const Eigen::Isometry3d back = at.pose().inverse();
  const Vector6d later = vectorFromMotion(back * trajectory.at(time + range).pose());
  const Vector6d earlier = vectorFromMotion(back * trajectory.at(time - range).pose());
  ExposureMotion motion;
  motion.velocity << at.rotation.transpose() * at.velocity, at.rate;
  motion.acceleration = (later + earlier) / (range * range);
  motion.angular_jerk =
      6.0 / (range * range) * ((later - earlier).tail<3>() / (2.0 * range) - motion.velocity.tail<3>());
  return motion;
}

}  // namespace

/// Whether `window` ends with this one and a new pair, which the trajectory can reach with a bounded number
/// of knots.
bool TrackWindow::follows(const std::vector<WindowFrame>& window) const {
  const auto& pairs = state_.problem.pairs;
  const Trajectory& trajectory = state_.problem.trajectory;
  if (pairs.empty() || pairs.size() + 1 > window.size()) return false;
  const double time = 1e-9 * static_cast<double>(window.back().exposure_ns - state_.epoch_ns);
  const double end = time + reachOf(state_.problem.shared, window.back().offset).after;
  return trajectory.size() + (end - trajectory.end()) / trajectory.interval() < kMostKnots &&
         std::equal(
             pairs.begin(), pairs.end(), window.end() - 1 - static_cast<std::ptrdiff_t>(pairs.size()),
             [](const WindowPair& pair, const WindowFrame& frame) { return pair.index == frame.index; });
}

/// A window of all pairs but the newest, whose oldest pose has the covariance that it was published with.
/// After a standstill, of its last pair.
void TrackWindow::restart(const TrackWindowInput& input, State& state) {
  const State before = std::exchange(state, {});
  WindowProblem& problem = state.problem;
  if (before.jerk_sums.freedom[0] > 0.0 && !input.rest) {
    problem.noise = before.problem.noise;
    problem.jerk = before.problem.jerk;
    state.jerk_sums = before.jerk_sums;
  } else {  // images at rest tell nothing of a drive
    state.jerk_sums.freedom.setConstant(kJerkFreedom);
    state.jerk_sums.squares << std::pow(problem.jerk.translation, 2), std::pow(problem.jerk.rotation, 2);
    state.jerk_sums.squares *= kJerkFreedom;
  }
  problem.camera = input.camera;
  const std::span<const WindowFrame> all(input.window), window = input.rest ? all.last(2) : all;
  state.epoch_ns = window.front().exposure_ns;
  const std::vector<double> times = timesOf(window, state.epoch_ns);
  for (std::size_t i = 0; i + 1 < window.size(); ++i)
    problem.pairs.push_back({.index = window[i].index, .time = times[i], .offset = window[i].offset});
  if (input.rest)
    for (WindowPair& pair : problem.pairs)
      pair.twist_covariance.diagonal() = input.rest->cwiseAbs2();
  problem.shared = problem.prior.first_shared = input.shared.mean;
  problem.prior.information.diagonal() =
      input.shared.stddev.cwiseMax(kLeastStddev).cwiseAbs2().cwiseInverse();

  const WindowFrame& first = window.front();
  const double start = -reachOf(problem.shared, first.offset).before;
  const double end = times.back() + reachOf(problem.shared, window.back().offset).after;
  const double interval = std::max(times.back() / static_cast<double>(times.size() - 1) / kKnotsOfPair,
                                   (end - start) / kMostKnotsOfStart);
  problem.trajectory = Trajectory(start, interval, first.T_world_camera);
  problem.trajectory.extendTo(end);
  for (int i = 0; i < problem.trajectory.size(); ++i)
    problem.trajectory.set(i, poseOf(window, times, problem.trajectory.timeOf(i)));
  Matrix6d gauge = first.pose_covariance;
  const Eigen::Matrix3d& rotation = first.T_world_camera.linear();
  gauge.topRows<3>() = rotation * gauge.topRows<3>();
  gauge.leftCols<3>() = gauge.leftCols<3>() * rotation.transpose();
  gauge.diagonal().array() += kGaugeStddev * kGaugeStddev;
  tieToStart(0.0, first.T_world_camera, gauge, input.rest.value_or(Vector6d::Constant(track_start::kSpeed)),
             problem);
}

/// Moves the landmarks that are no longer seen into the prior, with a full window the oldest pair too.
void TrackWindow::removeEnded(const TrackWindowInput& input) {
  WindowProblem& problem = next_.problem;
  std::vector<WindowLandmark> ended;
  std::size_t kept = 0, at = 0;
  for (std::size_t i = 0; i < next_.keys.size(); ++i) {
    while (at < chosen_.size() && chosen_[at].first < next_.keys[i])
      ++at;
    if (at == chosen_.size() || chosen_[at].first != next_.keys[i]) {
      ended.push_back(problem.landmarks[i]);
      continue;
    }
    next_.keys[kept] = next_.keys[i];
    problem.landmarks[kept++] = problem.landmarks[i];
  }
  next_.keys.resize(kept);
  problem.landmarks.resize(kept);
  int knots = 0;
  const bool full = problem.pairs.size() + 1 >= kMaximumWindowPairs;
  if (full) {
    const WindowPair& oldest = problem.pairs[1];
    const double start = oldest.time - reachOf(problem.shared, oldest.offset).before;
    knots = problem.trajectory.at(start).first;
  }
  solver_.marginalise(problem, ended, knots);
  if (!full) return;
  for (std::size_t i = 1; i < problem.pairs.size(); ++i)
    problem.pairs[i - 1] = problem.pairs[i];
  problem.pairs.resize(problem.pairs.size() - 1);
  const double seconds = secondsBetween(input.window[input.window.size() - 2], input.window.back());
  problem.prior.addSharedNoise(seconds * input.shared.drift.cwiseAbs2());
}

/// A pair by the trajectory, but for its covariance.
TrackWindow::Pair TrackWindow::pairOf(const WindowPair& pair) const {
  const WindowProblem& problem = next_.problem;
  const double range = std::max(1e-3, 0.5 * std::abs(problem.shared[kLeftReadout]));
  const double right_time = pair.time + pair.offset + problem.shared[kOffset];
  const Eigen::Isometry3d T_left_right = leftFromRight(problem.camera.baseline);
  Pair result;
  result.T_world_camera = problem.trajectory.at(pair.time).pose();
  result.motion = motionAt(problem.trajectory, pair.time, range);
  result.right.T_left_right =
      result.T_world_camera.inverse() * problem.trajectory.at(right_time).pose() * T_left_right;
  result.right.motion =
      motionAbout(motionAt(problem.trajectory, right_time, range), 0.0, T_left_right, range);
  return result;
}

/// Keeps the covariances that the twists of the two newest pairs would have with readouts and offset told, if
/// one of these is unknown.
void TrackWindow::keepTwistErrors(const WindowResult& result) {
  constexpr int kTimes = kOffset + 1;
  WindowProblem& problem = next_.problem;
  const Eigen::Matrix3d times = result.covariance.topLeftCorner<kTimes, kTimes>();
  if (times.trace() < 6.0 * kLeastStddev * kLeastStddev) return;
  const auto columns = result.covariance.leftCols<kTimes>();
  WindowResult told;
  told.covariance = result.covariance - columns * times.inverse() * columns.transpose();
  for (int i = static_cast<int>(problem.pairs.size()) - 2; i < static_cast<int>(problem.pairs.size()); ++i) {
    WindowPair& pair = problem.pairs[i];
    Matrix6d to_world = Matrix6d::Identity();
    to_world.topLeftCorner<3, 3>() = problem.trajectory.at(pair.time).rotation;
    pair.twist_covariance = to_world * twistAt(problem, told, pair.time).covariance * to_world.transpose();
  }
}

TrackWindow::Adjusted TrackWindow::concluded(const WindowResult& result) {
  const WindowProblem& problem = next_.problem;
  const std::size_t last = problem.pairs.size() - 1;
  Adjusted adjusted;
  for (const WindowPair& pair : problem.pairs) {
    adjusted.pairs.push_back(pairOf(pair));
    adjusted.pairs.back().pose_covariance = poseAt(problem, result, pair.time).covariance;
  }
  const auto motion_to = [&](std::size_t pair) {
    return motionBetween(problem, result, problem.pairs[pair - 1].time, problem.pairs[pair].time);
  };
  adjusted.motion = motion_to(last);
  if (last > 1) adjusted.motion_before = motion_to(last - 1);
  adjusted.twist = twistAt(problem, result, problem.pairs[last].time);
  adjusted.twist_before = twistAt(problem, result, problem.pairs[last - 1].time);
  keepTwistErrors(result);
  adjusted.shared = problem.shared;
  adjusted.shared_stddev =
      result.covariance.topLeftCorner<kSharedStates, kSharedStates>().diagonal().cwiseMax(0.0).cwiseSqrt();
  adjusted.explained = solver_.explains(problem);
  listAdjusted(adjusted.pairs);
  return adjusted;
}

/// Sets next_ to the window with its newest pair at its first guess, if that has not been done.
void TrackWindow::prepare(const TrackWindowInput& input) {
  choose(input);
  const WindowFrame& newest = input.window.back();
  WindowProblem& problem = next_.problem;
  if (!problem.pairs.empty() && problem.pairs.back().index == newest.index) {
    addLandmarks(input);
    return;
  }
  next_ = state_;
  if (input.rest || !follows(input.window)) restart(input, next_);
  removeEnded(input);
  const std::vector<double> times = timesOf(input.window, next_.epoch_ns);
  const double time = times.back();
  WindowPair pair{.index = newest.index, .time = time, .offset = newest.offset};
  if (!problem.pairs.empty()) pair.twist_covariance = problem.pairs.back().twist_covariance;
  problem.pairs.push_back(pair);
  problem.trajectory.extendTo(time + reachOf(problem.shared, newest.offset).after);
  // The last knots were hardly measured before: they begin at the first guess.
  for (int i = 0; i < problem.trajectory.size(); ++i)
    if (problem.trajectory.timeOf(i) > times[times.size() - 2])
      problem.trajectory.set(i, poseOf(input.window, times, problem.trajectory.timeOf(i)));
  ++next_.young;
  addLandmarks(input);
}

/// Moves the other unknowns to where they are most likely with this yaw (rad).
void TrackWindow::assumeYaw(double yaw, const WindowResult& result) {
  WindowProblem& problem = next_.problem;
  const Eigen::VectorXd step =
      (yaw - problem.shared[kYaw]) / result.covariance(kYaw, kYaw) * result.covariance.col(kYaw);
  problem.shared += step.head<kSharedStates>();
  for (int i = 0; i < problem.trajectory.size(); ++i)
    problem.trajectory.move(i, step.segment<6>(columnOf(i)));
}

std::optional<TrackWindow::Pair> TrackWindow::predict(const TrackWindowInput& input) {
  prepare(input);
  WindowProblem& problem = next_.problem;
  const bool young = next_.young <= kPairsOfStart;
  if (!(young ? solver_.step(problem, kStartScales) : solver_.step(problem, kPredictionScales)) ||
      !solver_.explains(problem)) {
    problem.pairs.clear();
    return std::nullopt;
  }
  return pairOf(problem.pairs.back());
}

std::optional<TrackWindow::Adjusted> TrackWindow::adjust(const TrackWindowInput& input) {
  prepare(input);
  WindowProblem& problem = next_.problem;
  const bool young = next_.young <= kPairsOfStart;
  const WindowResult result = young ? solver_.solve(problem, kStartScales) : solver_.solve(problem, kScales);
  if (!result.converged || problem.shared.head<kOffset + 1>().cwiseAbs().maxCoeff() > kLongestReadout)
    return std::nullopt;
  const double share = std::max(1.0 / input.correlated_pairs, 1.0 / (1.0 + next_.young));
  for (std::size_t level = 0; level < problem.noise.size(); ++level) {
    WindowNoise& noise = problem.noise[level];
    noise.left += share * (result.noise[level].left - noise.left);
    noise.right += share * (result.noise[level].right - noise.right);
    noise.common += share * (result.noise[level].common - noise.common);
  }
  WindowJerkSums& sums = next_.jerk_sums;
  const auto mean_of = [&](int part, double& jerk) {
    const double kept = 1.0 - share;
    sums.squares[part] = kept * sums.squares[part] + result.jerk.squares[part] * jerk * jerk;
    sums.freedom[part] = kept * sums.freedom[part] + result.jerk.freedom[part];
    jerk = std::max(kLeastJerk, std::sqrt(sums.squares[part] / sums.freedom[part]));
  };
  mean_of(0, problem.jerk.translation);
  mean_of(1, problem.jerk.rotation);
  // The rig file's yaw holds as long as the one found may be what the lenses leave: a landmark's patches in
  // both images have errors in common that no residual shows.
  const Trajectory trajectory = problem.trajectory;
  const SharedVector shared = problem.shared;
  const double yaw = shared[kYaw], pattern = input.shared.yaw_pattern;
  if (pattern > 0.0) assumeYaw(shrunk(yaw, result.covariance(kYaw, kYaw) + pattern * pattern), result);
  Adjusted adjusted = concluded(result);
  problem.trajectory = trajectory;
  problem.shared = adjusted.shared = shared;
  return adjusted;
}

void TrackWindow::accept() {
  std::swap(state_, next_);
}

void TrackWindow::forget() {
  state_.problem.pairs.clear();
  next_.problem.pairs.clear();
}

}  // namespace cartvo::vo
