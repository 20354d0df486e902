// Robust regression of vertical disparities on the row errors of the right camera.
#include "vo_core/self_calibration/row_measurement.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "common/statistics.hpp"
#include "vo_core/geometry/reprojection_lanes.hpp"
#include "vo_core/simd/simd_groups.hpp"

namespace cartvo::vo {
namespace {

using Vector = RowPatterns::Vector;
using Matrix = RowPatterns::Matrix;

constexpr std::size_t kMinimumMatches = 30;

/// Stereo matches of one anchor, one per lane.
struct RowBlock {
  int anchor = 0;
  PlaceLanes place{};
  DoubleLanes x{}, y{};    // right observation, at z = 1
  DoubleLanes residual{};  // px, measured vertical disparity minus predicted
  DoubleLanes counted{};   // 1 if the point is in front of both cameras
  DoubleLanes weight{};    // 0 for the others
  DoubleLanes by_pattern[RowPatterns::kSize]{};
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
    block.by_pattern[RowPatterns::kPitch] = -f * (1.0 + block.y * block.y);
    block.by_pattern[RowPatterns::kRoll] = f * block.x;
    block.by_pattern[RowPatterns::kCrossTerm] = f * block.x * block.y;
    const PoseLanes by_right = rowByCamera(right, block.place);
    DoubleLanes& by_delay = block.by_pattern[RowPatterns::kDelay] = DoubleLanes{};
    for (int i = 0; i < 6; ++i)
      by_delay -= f * right_by_offset[i] * by_right.value[i];
    const DoubleLanes x_squared = block.x * block.x, y_squared = block.y * block.y;
    block.by_pattern[RowPatterns::kRowScale] = f * block.y;
    block.by_pattern[RowPatterns::kRadial] = f * block.y * (x_squared + y_squared);
    block.by_pattern[RowPatterns::kDecentring] = f * (x_squared + 3.0 * y_squared);
    block.by_pattern[RowPatterns::kHeight] = -f * camera.baseline * by_right.value[1];
    block.by_pattern[RowPatterns::kDepth] = -f * camera.baseline * by_right.value[2];
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

/// Subtracts the patterns that are expected from the residuals, px.
CARTVO_TARGET_CLONES
void subtract(const Vector& expected, std::vector<RowBlock>& blocks) {
  for (RowBlock& block : blocks)
    for (int i = 0; i < RowPatterns::kSize; ++i)
      block.residual -= expected[i] * block.by_pattern[i];
}

/// Standard deviation of the residuals, px; 0 if there are too few.
double noiseOf(const std::vector<RowBlock>& blocks, double least, std::vector<double>& sizes) {
  sizes.clear();
  sizes.reserve(kDoubleLanes * blocks.capacity());
  for (const RowBlock& block : blocks)
    for (int lane = 0; lane < kDoubleLanes; ++lane)
      if (block.counted[lane] > 0.0) sizes.push_back(std::abs(block.residual[lane]));
  return sizes.size() < kMinimumMatches ? 0.0 : std::max(stddevFromMedian(sizes), least);
}

/// Sums of the normal equations, px.
struct RowSums {
  DoubleLanes products[RowPatterns::kSize][RowPatterns::kSize]{};  // the lower triangle
  DoubleLanes gradient[RowPatterns::kSize]{};
  DoubleLanes weights{};
};

/// `width`: px, of a residual that halves its weight.
CARTVO_TARGET_CLONES
void sumRows(const std::vector<RowBlock>& blocks, double width, RowSums& sums) {
  const double inverse_width_squared = 1.0 / (width * width);
  for (const RowBlock& block : blocks) {
    const DoubleLanes weight =
        block.weight / (1.0 + inverse_width_squared * (block.residual * block.residual));
    sums.weights += weight;
    for (int i = 0; i < RowPatterns::kSize; ++i) {
      const DoubleLanes weighted = weight * block.by_pattern[i];
      sums.gradient[i] += weighted * block.residual;
      for (int j = 0; j <= i; ++j)
        sums.products[i][j] += weighted * block.by_pattern[j];
    }
  }
}

/// (I^-1 + D)^-1 I^-1 = (1 + I D)^-1, where I may be singular. D: variance (rad^2) of an unknown pitch and
/// roll.
Matrix rotationUncertaintyFactor(const Matrix& information, double variance) {
  Vector variances = Vector::Zero();
  variances[RowPatterns::kPitch] = variances[RowPatterns::kRoll] = variance;
  const Matrix covariance = variances.asDiagonal();
  return (Matrix::Identity() + information * covariance).inverse();
}

}  // namespace

struct RowRegression::Work {
  RowBlocks rows;
  std::vector<double> sizes;
};

RowRegression::RowRegression(const SelfCalibrationSettings& settings)
    : settings_(settings), work_(std::make_unique<Work>()) {}
RowRegression::RowRegression(RowRegression&&) noexcept = default;
RowRegression& RowRegression::operator=(RowRegression&&) noexcept = default;
RowRegression::~RowRegression() = default;

RowMeasurement RowRegression::measure(const BundleProblem& adjusted, const Vector& expected) {
  auto& [rows, sizes] = *work_;
  rows.fill(adjusted);
  linearise(adjusted, rows.blocks);
  subtract(expected, rows.blocks);
  const double noise = noiseOf(rows.blocks, settings_.row_noise, sizes);
  if (!(noise > 0.0)) return {};
  RowSums sums;
  sumRows(rows.blocks, settings_.row_robust_width * noise, sums);
  RowMeasurement measurement;
  measurement.precision = sumOf(sums.weights) / (noise * noise);
  for (int i = 0; i < RowPatterns::kSize; ++i) {
    measurement.gradient[i] = sumOf(sums.gradient[i]) / (noise * noise);
    for (int j = 0; j <= i; ++j)
      measurement.information(i, j) = measurement.information(j, i) =
          sumOf(sums.products[i][j]) / (noise * noise);
  }
  measurement.mean_products = measurement.information / measurement.precision;
  const double rotation = settings_.rate_stddev * adjusted.poses.back().offset;
  const Matrix factor = rotationUncertaintyFactor(measurement.information, rotation * rotation);
  measurement.information = factor * measurement.information.eval();
  measurement.gradient = factor * measurement.gradient.eval();
  if (!measurement.information.allFinite() || !measurement.gradient.allFinite()) return {};
  return measurement;
}

}  // namespace cartvo::vo
