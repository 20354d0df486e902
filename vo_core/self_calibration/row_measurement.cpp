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
  DoubleLanes x{}, y{};    // right observation, at z = 1
  DoubleLanes residual{};  // px, measured vertical disparity minus predicted
  DoubleLanes counted{};   // 1 if the point is in front of both cameras
  DoubleLanes weight{};    // 0 for the others
  DoubleLanes by_errors[RowErrors::kSize]{};
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
void linearise(double f, const RowCamerasOfAnchors& cameras, const Vector6d& right_by_offset,
               std::vector<RowBlock>& blocks) {
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
  linearise(problem.camera.focal_length, cameras, right.by_offset, blocks);
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

/// Sums of the normal equations, px.
struct RowSums {
  DoubleLanes products[RowErrors::kSize][RowErrors::kSize]{};  // the lower triangle
  DoubleLanes gradient[RowErrors::kSize]{};
  DoubleLanes weights{};
};

CARTVO_TARGET_CLONES
void addRows(const std::vector<RowBlock>& blocks, const Vector& errors, double noise, RowSums& sums) {
  const double inverse_width_squared = 1.0 / (kRobustWidth * kRobustWidth * noise * noise);
  for (const RowBlock& block : blocks) {
    DoubleLanes remaining;
    remainingResidual(block, errors, remaining);
    const DoubleLanes weight = block.weight / (1.0 + inverse_width_squared * (remaining * remaining));
    sums.weights += weight;
    for (int i = 0; i < RowErrors::kSize; ++i) {
      const DoubleLanes weighted = weight * block.by_errors[i];
      sums.gradient[i] += weighted * block.residual;
      for (int j = 0; j <= i; ++j)
        sums.products[i][j] += weighted * block.by_errors[j];
    }
  }
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
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    collectSizes(rows.blocks, measurement.errors, sizes);
    if (sizes.size() < kMinimumMatches) return {};
    const double noise = std::max(stddevFromMedian(sizes), kMinimumNoise);
    RowSums sums;
    addRows(rows.blocks, measurement.errors, noise, sums);
    const double weights = sumOf(sums.weights);
    if (!(weights > 0.0)) return {};
    Matrix products;
    Vector gradient;
    for (int i = 0; i < RowErrors::kSize; ++i) {
      gradient[i] = sumOf(sums.gradient[i]);
      for (int j = 0; j <= i; ++j)
        products(i, j) = products(j, i) = sumOf(sums.products[i][j]);
    }
    measurement.information = products / (noise * noise);
    measurement.mean_products = products / weights;
    measurement.errors = (measurement.information + prior).ldlt().solve(gradient / (noise * noise));
  }
  // (I^-1 + D)^-1 = (1 + I D)^-1 I, where I may be singular.
  const double rotation_stddev =
      (adjusted.poses.size() > 1 ? kRateStddev : kUnknownRateStddev) * adjusted.poses.back().offset;
  const Matrix rotation_covariance =
      Vector(rotation_stddev * rotation_stddev, rotation_stddev * rotation_stddev, 0.0, 0.0).asDiagonal();
  measurement.information = (Matrix::Identity() + measurement.information * rotation_covariance).inverse() *
                            measurement.information.eval();
  if (!measurement.errors.allFinite() || !measurement.information.allFinite()) return {};
  return measurement;
}

}  // namespace cartvo::vo
