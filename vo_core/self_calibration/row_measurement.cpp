// Robust regression of vertical disparities on the row errors of the right camera.
#include "vo_core/self_calibration/row_measurement.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "common/statistics.hpp"
#include "vo_core/geometry/reprojection_lanes.hpp"
#include "vo_core/simd/simd_groups.hpp"

namespace cartvo::vo {
namespace {

using Vector = RowErrors::Vector;
using Matrix = RowErrors::Matrix;

constexpr std::size_t kMinimumMatches = 30;
constexpr int kIterations = 4;  // of weights and noise; each halves the remaining effect of the initial guess
constexpr double kMinimumNoise = 0.02;  // px, of a row
constexpr double kRobustWidth = 2.0;    // standard deviations of a residual that halve its weight
// Standard deviations of the prior that keeps undetermined errors near zero: rad, rad, rad, s.
const Vector kPriorStddev(1e-2, 1e-2, 1e-2, 1e-1);
// rad/s, standard deviation of the angular rate between two pairs' exposures: times the offset, the rotation
// between left and right exposure that the poses do not show.
constexpr double kRateStddev = 0.02;
constexpr double kUnknownRateStddev = 0.3;  // rad/s, of a single pair: 3 m/s past a point 10 m away

/// Stereo matches of one anchor, one per lane.
struct RowBlock {
  int anchor = 0;
  PlaceLanes place{};
  DoubleLanes x{}, y{};                         // right observation, at z = 1
  DoubleLanes residual{};                       // px, measured vertical disparity minus predicted
  DoubleLanes counted{};                        // 1 if the point is in front of both cameras
  DoubleLanes weight{};                         // 0 for the others
  DoubleLanes by_errors[RowPatterns::kSize]{};  // the first are by RowErrors
};

/// Stereo matches of a problem's newest pair, grouped by anchor.
class RowBlocks {
 public:
  /// Fills the blocks; residuals are the measured vertical disparities.
  void fill(const BundleProblem& problem);

  std::vector<RowBlock> blocks;

 private:
  SimdGroups order_;
  std::vector<const BundleLandmark*> matched_;
};

void RowBlocks::fill(const BundleProblem& problem) {
  const int newest = static_cast<int>(problem.poses.size()) - 1;
  matched_.clear();
  matched_.reserve(problem.landmarks.capacity());
  for (const BundleLandmark& landmark : problem.landmarks)
    if (const BundleObservation& last = landmark.observations.back(); last.pose == newest && last.stereo)
      matched_.push_back(&landmark);
  order_.reserve(matched_.capacity());
  order_.sort(problem.poses.size(), matched_.size(),
              [&](std::size_t i) { return matched_[i]->observations.front().pose; });
  blocks.clear();
  blocks.reserve(order_.maximumBlocks());
  order_.forEachBlock([&](int anchor, const int* indices, int count) {
    RowBlock& block = blocks.emplace_back();
    block.anchor = anchor;
    for (int lane = 0; lane < count; ++lane) {
      const BundleLandmark& landmark = *matched_[indices[lane]];
      const BundleObservation& observation = landmark.observations.back();
      for (int axis = 0; axis < 3; ++axis)
        block.place.bearing[axis][lane] = landmark.bearing[axis];
      block.place.inverse_depth[lane] = landmark.inverse_depth;
      const Eigen::Vector3d seen = bearingOf(problem.camera, observation.right);
      block.x[lane] = seen.x();
      block.y[lane] = seen.y();
      block.residual[lane] = observation.left.y() - observation.right.y();
      block.weight[lane] = landmark.weight;
      block.counted[lane] = 1.0;
    }
  });
}

/// Transforms from an anchor to the two cameras.
struct RowCameras {
  Eigen::Isometry3d T_left_anchor, T_right_anchor;
};
using RowCamerasOfAnchors = FixedVector<RowCameras, kMaximumWindowPairs>;

CARTVO_TARGET_CLONES
void linearise(const StereoCamera& camera, const RowCamerasOfAnchors& cameras,
               const Vector6d& right_by_offset, std::vector<RowBlock>& blocks) {
  const double f = camera.focal_length;
  for (RowBlock& block : blocks) {
    const RayLanes left_ray = rayOf(cameras[block.anchor].T_left_anchor, block.place);
    const RayLanes right_ray = rayOf(cameras[block.anchor].T_right_anchor, block.place);
    for (const RayLanes* ray : {&left_ray, &right_ray}) {
      BitLanes behind;
      findNegative(ray->z - kNearestRay, behind);
      keepWhere(~behind, block.counted);
    }
    block.weight *= block.counted;
    const ViewLanes left = viewOf(left_ray), right = viewOf(right_ray);
    block.residual -= f * (left.y - right.y);
    block.by_errors[RowErrors::kPitch] = -f * (1.0 + block.y * block.y);
    block.by_errors[RowErrors::kRoll] = f * block.x;
    block.by_errors[RowErrors::kCrossTerm] = f * block.x * block.y;
    const PoseLanes by_right = rowByCamera(right, block.place);
    DoubleLanes& by_delay = block.by_errors[RowErrors::kDelay] = DoubleLanes{};
    for (int i = 0; i < 6; ++i)
      by_delay -= f * right_by_offset[i] * by_right.value[i];
    const DoubleLanes x_squared = block.x * block.x, y_squared = block.y * block.y;
    block.by_errors[RowPatterns::kRowScale] = f * block.y;
    block.by_errors[RowPatterns::kRadial] = f * block.y * (x_squared + y_squared);
    block.by_errors[RowPatterns::kDecentring] = f * (x_squared + 3.0 * y_squared);
    block.by_errors[RowPatterns::kHeight] = -f * camera.baseline * by_right.value[1];
    block.by_errors[RowPatterns::kDepth] = -f * camera.baseline * by_right.value[2];
  }
}

/// Subtracts the predicted vertical disparities from the residuals and computes the derivatives by the
/// errors.
void linearise(const BundleProblem& problem, std::vector<RowBlock>& blocks) {
  const int newest = static_cast<int>(problem.poses.size()) - 1;
  const RightCamera right = rightCameraOf(problem.poses, newest, problem.camera.baseline);
  const Eigen::Isometry3d left_inverse = problem.poses.back().T_world_camera.inverse();
  const Eigen::Isometry3d right_inverse = right.T_world_camera.inverse();
  RowCamerasOfAnchors cameras;
  for (const TimedPose& anchor : problem.poses)
    cameras.push_back({left_inverse * anchor.T_world_camera, right_inverse * anchor.T_world_camera});
  linearise(problem.camera, cameras, right.by_offset, blocks);
}

/// Residuals after the errors, px.
inline void remainingResidual(const RowBlock& block, const Vector& errors, DoubleLanes& remaining) {
  remaining = block.residual;
  for (int i = 0; i < RowErrors::kSize; ++i)
    remaining -= errors[i] * block.by_errors[i];
}

CARTVO_TARGET_CLONES
void collectSizes(const std::vector<RowBlock>& blocks, const Vector& errors, std::vector<double>& sizes) {
  sizes.clear();
  sizes.reserve(kDoubleLanes * blocks.capacity());
  for (const RowBlock& block : blocks) {
    DoubleLanes remaining;
    remainingResidual(block, errors, remaining);
    for (int lane = 0; lane < kDoubleLanes; ++lane)
      if (block.counted[lane] > 0.0) sizes.push_back(std::abs(remaining[lane]));
  }
}

/// Sums of the normal equations for the first `Size` patterns, px.
template <int Size>
struct RowSums {
  Eigen::Matrix<double, Size, Size> information(double noise) const {
    Eigen::Matrix<double, Size, Size> all;
    for (int i = 0; i < Size; ++i)
      for (int j = 0; j <= i; ++j)
        all(i, j) = all(j, i) = sumOf(products[i][j]);
    return all / (noise * noise);
  }
  Eigen::Matrix<double, Size, 1> scaledGradient(double noise) const {
    Eigen::Matrix<double, Size, 1> all;
    for (int i = 0; i < Size; ++i)
      all[i] = sumOf(gradient[i]);
    return all / (noise * noise);
  }

  DoubleLanes products[Size][Size]{};  // the lower triangle
  DoubleLanes gradient[Size]{};
  DoubleLanes weights{};
};

template <int Size>
inline void addRows(const std::vector<RowBlock>& blocks, const Vector& errors, double noise,
                    RowSums<Size>& sums) {
  const double inverse_width_squared = 1.0 / (kRobustWidth * kRobustWidth * noise * noise);
  for (const RowBlock& block : blocks) {
    DoubleLanes remaining;
    remainingResidual(block, errors, remaining);
    const DoubleLanes weight = block.weight / (1.0 + inverse_width_squared * (remaining * remaining));
    sums.weights += weight;
    for (int i = 0; i < Size; ++i) {
      const DoubleLanes weighted = weight * block.by_errors[i];
      sums.gradient[i] += weighted * block.residual;
      for (int j = 0; j <= i; ++j)
        sums.products[i][j] += weighted * block.by_errors[j];
    }
  }
}

CARTVO_TARGET_CLONES
void sumErrors(const std::vector<RowBlock>& blocks, const Vector& errors, double noise,
               RowSums<RowErrors::kSize>& sums) {
  addRows(blocks, errors, noise, sums);
}

CARTVO_TARGET_CLONES
void sumPatterns(const std::vector<RowBlock>& blocks, const Vector& errors, double noise,
                 RowSums<RowPatterns::kSize>& sums) {
  addRows(blocks, errors, noise, sums);
}

/// (I^-1 + D)^-1 I^-1 = (1 + I D)^-1, where I may be singular. D: variance (rad^2) of an unknown pitch and
/// roll.
template <int Size>
Eigen::Matrix<double, Size, Size> rotationUncertaintyFactor(
    const Eigen::Matrix<double, Size, Size>& information, double variance) {
  Eigen::Matrix<double, Size, 1> variances = Eigen::Matrix<double, Size, 1>::Zero();
  variances[RowErrors::kPitch] = variances[RowErrors::kRoll] = variance;
  const Eigen::Matrix<double, Size, Size> covariance = variances.asDiagonal();
  return (Eigen::Matrix<double, Size, Size>::Identity() + information * covariance).inverse();
}

RowEquations rowEquations(const std::vector<RowBlock>& blocks, const Vector& errors, double noise,
                          double rotation_variance) {
  RowSums<RowPatterns::kSize> sums;
  sumPatterns(blocks, errors, noise, sums);
  const double weights = sumOf(sums.weights);
  if (!(weights > 0.0)) return {};
  RowEquations equations;
  equations.information = sums.information(noise);
  equations.mean_products = sums.information(1.0) / weights;
  const RowPatterns::Matrix factor = rotationUncertaintyFactor(equations.information, rotation_variance);
  equations.gradient = factor * sums.scaledGradient(noise);
  equations.information = factor * equations.information.eval();
  return equations;
}

}  // namespace

struct RowRegression::Work {
  RowBlocks rows;
  std::vector<double> sizes;
};

RowRegression::RowRegression() : work_(std::make_unique<Work>()) {}
RowRegression::RowRegression(RowRegression&&) noexcept = default;
RowRegression& RowRegression::operator=(RowRegression&&) noexcept = default;
RowRegression::~RowRegression() = default;

RowMeasurement measureRows(const BundleProblem& adjusted) {
  return RowRegression().measure(adjusted);
}

RowMeasurement RowRegression::measure(const BundleProblem& adjusted) {
  RowMeasurement measurement;
  auto& [rows, sizes] = *work_;
  rows.fill(adjusted);
  linearise(adjusted, rows.blocks);
  const Matrix prior = kPriorStddev.cwiseAbs2().cwiseInverse().asDiagonal();
  double noise = kMinimumNoise;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    collectSizes(rows.blocks, measurement.errors, sizes);
    if (sizes.size() < kMinimumMatches) return {};
    noise = std::max(stddevFromMedian(sizes), kMinimumNoise);
    RowSums<RowErrors::kSize> sums;
    sumErrors(rows.blocks, measurement.errors, noise, sums);
    const double weights = sumOf(sums.weights);
    if (!(weights > 0.0)) return {};
    measurement.information = sums.information(noise);
    measurement.mean_products = sums.information(1.0) / weights;
    measurement.errors = (measurement.information + prior).ldlt().solve(sums.scaledGradient(noise));
  }
  const double rotation_stddev =
      (adjusted.poses.size() > 1 ? kRateStddev : kUnknownRateStddev) * adjusted.poses.back().offset;
  const double rotation_variance = rotation_stddev * rotation_stddev;
  measurement.equations = rowEquations(rows.blocks, measurement.errors, noise, rotation_variance);
  measurement.information =
      rotationUncertaintyFactor(measurement.information, rotation_variance) * measurement.information.eval();
  if (!measurement.errors.allFinite() || !measurement.information.allFinite()) return {};
  if (!measurement.equations.information.allFinite() || !measurement.equations.gradient.allFinite())
    measurement.equations = {};
  return measurement;
}

}  // namespace cartvo::vo
